// SPDX-License-Identifier: GPL-3.0-or-later
// Length and area estimators (thesis 5.1.1) against closed forms.
#include "benchmarks/study/length.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "benchmarks/study/initial_conditions.hpp"
#include "model/error.hpp"

namespace heartgen::study {
namespace {

constexpr double pi = std::numbers::pi;

/// phi = nx x + ny y - d, a straight line across the plane.
Field half_plane(int size, double nx, double ny, double d) {
  Field phi(size, size);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) phi(i, j) = nx * i + ny * j - d;
  return phi;
}

Field scaled(Field phi, double factor) {
  for (double& value : phi.values) value *= factor;
  return phi;
}

Volume<double> ball(int size, double radius, const Vec3& spacing_mm = {1, 1, 1}) {
  Grid grid;
  grid.size = {size, size, size};
  grid.spacing_mm = spacing_mm;
  Volume<double> phi(grid);
  const double c = 0.5 * (size - 1);
  for (int k = 0; k < size; ++k)
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i)
        phi(i, j, k) = radius - norm(Vec3{(i - c) * spacing_mm.x, (j - c) * spacing_mm.y, (k - c) * spacing_mm.z});
  return phi;
}

/// Ramanujan's perimeter of an ellipse, exact to 1e-6 at these axes.
double ellipse_perimeter(double a, double b) {
  const double h = (a - b) * (a - b) / ((a + b) * (a + b));
  return pi * (a + b) * (1 + 3 * h / (10 + std::sqrt(4 - 3 * h)));
}

TEST(Length, CircleFromItsDistance) {
  for (const double center : {79.5, 80.0, 79.8}) {
    const Field phi = circle_start(160, 160, center, center - 0.3, 50);
    const double real = 2 * pi * 50;
    EXPECT_NEAR(gaussian_length(phi, 2.5) / real, 1, 1e-4);
    EXPECT_NEAR(gaussian_length(phi, 7) / real, 1, 1e-4);
    EXPECT_NEAR(smereka_length(phi) / real, 1, 2e-3);
    EXPECT_NEAR(piecewise_linear_length(phi) / real, 1, 1e-4);
  }
}

TEST(Length, ErrorsOfTheLinearLengthFallWithTheSquareOfTheRadius) {
  double before = 0;
  for (const int radius : {10, 20, 40}) {
    const double error =
        1 - piecewise_linear_length(circle_start(2 * radius + 9, 2 * radius + 9, radius + 4.2, radius + 3.9, radius)) /
                (2 * pi * radius);
    EXPECT_GT(error, 0);  // a chord is shorter than its arc
    if (before > 0) {
      EXPECT_NEAR(before / error, 4, 0.5);
    }
    before = error;
  }
}

TEST(Length, StraightLinesAreExact) {
  // Through the whole plane of pixel centres: from i = 0 to size - 1.
  for (const double slope : {0.0, 0.25, 0.7, -0.4}) {
    const Field phi = half_plane(64, slope, 1, 31.3 + 31 * slope);
    EXPECT_NEAR(piecewise_linear_length(phi), 63 * std::hypot(1, slope), 1e-9);
  }
  EXPECT_NEAR(smereka_length(half_plane(64, 0, 1, 31.3)), 64, 1e-6);
}

TEST(Length, HeavisideCountsEdgesAndCorners) {
  EXPECT_DOUBLE_EQ(heaviside_length(half_plane(64, 0, 1, 31.3)), 64);
  // A descending staircase of 63 steps has no pixel with both differences, a rising one has one per step.
  const EdgeCrossings down = edge_crossings(half_plane(64, 1, -1, 0.5)),
                      up = edge_crossings(half_plane(64, 1, 1, 62.5));
  EXPECT_EQ(down.corners, 0);
  EXPECT_GE(up.corners, 62);
  // For circles the mean over all directions: 4/π - (2 - √2)/2 · 4/π (1 - 1/√2).
  const double limit = 4 / pi * (1 - (2 - std::numbers::sqrt2) / 2 * (1 - std::numbers::sqrt2 / 2));
  EXPECT_NEAR(heaviside_length(circle_start(420, 420, 209.6, 209.3, 200)) / (2 * pi * 200), limit, 2e-3);
}

TEST(Length, Ellipse) {
  Field phi(160, 120);
  for (int j = 0; j < 120; ++j)
    for (int i = 0; i < 160; ++i) phi(i, j) = 1 - std::hypot((i - 79.7) / 60, (j - 59.2) / 35);
  const double real = ellipse_perimeter(60, 35);
  EXPECT_NEAR(piecewise_linear_length(phi) / real, 1, 2e-4);
  EXPECT_NEAR(smereka_length(phi) / real, 1, 3e-3);
}

TEST(Length, ScalingOfTheFunctionAndOfThePlane) {
  const Field phi = circle_start(100, 100, 49.7, 50.1, 30);
  for (const double m : {0.25, 8.0}) {
    EXPECT_EQ(heaviside_length(scaled(phi, m)), heaviside_length(phi));
    EXPECT_NEAR(piecewise_linear_length(scaled(phi, m)), piecewise_linear_length(phi), 1e-10);
    EXPECT_NEAR(smereka_length(scaled(phi, m)), smereka_length(phi), 1e-6);
  }
  EXPECT_GT(std::abs(gaussian_length(scaled(phi, 0.1), 10) / gaussian_length(phi, 10) - 1), 0.02);
  for (const double h : {0.5, 3.0}) {
    EXPECT_DOUBLE_EQ(heaviside_length(phi, h), h * heaviside_length(phi));
    EXPECT_DOUBLE_EQ(piecewise_linear_length(scaled(phi, h), h), h * piecewise_linear_length(phi));
    EXPECT_NEAR(smereka_length(scaled(phi, h), h), h * smereka_length(phi), 1e-6);
    EXPECT_NEAR(gaussian_length(scaled(phi, h), 2.5 * h, h), h * gaussian_length(phi, 2.5), 1e-9);
  }
}

TEST(Length, SignDoesNotMatter) {
  const Field phi = circle_start(100, 100, 49.7, 50.1, 30);
  EXPECT_NEAR(piecewise_linear_length(scaled(phi, -1)), piecewise_linear_length(phi), 1e-10);
  EXPECT_NEAR(smereka_length(scaled(phi, -1)), smereka_length(phi), 1e-9);
}

TEST(Length, PixelsOnTheCurveCountOnce) {
  // Radius 100 around a pixel: 20 pixels lie on the circle exactly.
  const Field phi = circle_start(240, 240, 120, 120, 100);
  EXPECT_NEAR(smereka_length(phi) / (200 * pi), 1, 2e-3);
  EXPECT_NEAR(piecewise_linear_length(phi) / (200 * pi), 1, 1e-4);
}

TEST(Area, Sphere) {
  const Volume<double> phi = ball(52, 20.3);
  const double real = 4 * pi * 20.3 * 20.3;
  EXPECT_NEAR(tetrahedra_area(phi) / real, 1, 1e-3);
  EXPECT_NEAR(smereka_area(phi) / real, 1, 5e-3);
  EXPECT_NEAR(gaussian_area(phi, 1.5) / real, 1, 4e-3);
  EXPECT_GT(heaviside_area(phi) / real, 1.1);
}

TEST(Area, AnisotropicVoxels) {
  const Volume<double> phi = ball(48, 18.2, {1, 0.9, 1.3});
  EXPECT_NEAR(tetrahedra_area(phi) / (4 * pi * 18.2 * 18.2), 1, 2e-3);
  EXPECT_THROW(smereka_area(phi), UserError);
}

TEST(Area, PlanesAreExact) {
  Grid grid;
  grid.size = {12, 10, 14};
  Volume<double> phi(grid);
  for (int k = 0; k < 14; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 12; ++i) phi(i, j, k) = k - 6.3 + 0.2 * i - 0.1 * j;
  EXPECT_NEAR(tetrahedra_area(phi), 11 * 9 * std::sqrt(1 + 0.04 + 0.01), 1e-9);
}

}  // namespace
}  // namespace heartgen::study
