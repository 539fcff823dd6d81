// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/snake.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "generator/pde/cyclic_pentadiagonal.hpp"
#include "generator/pde/edge_function.hpp"
#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen {
namespace {

using namespace testing;
using namespace pde;
using std::numbers::pi;

constexpr Point2 middle{31.5, 31.5};

Volume<float> flat_edges() { return Volume<float>(grid_of({64, 64, 1}), 1); }

Volume<float> edges_of(const Volume<float>& image, const EdgeSettings& settings) {
  return parallel::gather(edge_function(slab_of(image), settings, parallel::self()), parallel::self());
}

double radius_of(const Curve& curve) { return std::sqrt(area_mm2(curve) / pi); }

SnakeSettings only(double tension, double rigidity, double balloon) {
  SnakeSettings settings;
  settings.tension_mm = tension;
  settings.rigidity_mm3 = rigidity;
  settings.attraction_mm = 0;
  settings.balloon = balloon;
  settings.tolerance_mm = 0;
  return settings;
}

TEST(CyclicPentadiagonal, SolvesTheSystem) {
  std::mt19937 random(7);
  for (const std::size_t n : {5U, 6U, 7U, 40U}) {
    const PentadiagonalRow row{9, -3.1, 0.8};
    std::vector<double> x(n), b(n, 0.0);
    for (auto& v : x) v = static_cast<double>(random()) / 1e9;
    for (std::size_t i = 0; i < n; ++i)
      b[i] = row.middle * x[i] + row.near * (x[(i + 1) % n] + x[(i + n - 1) % n]) +
             row.far * (x[(i + 2) % n] + x[(i + n - 2) % n]);
    auto twice = b;
    for (auto& v : twice) v *= 2;
    solve_cyclic(row, {&b, &twice});
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(b[i], x[i], 1e-10);
      EXPECT_NEAR(twice[i], 2 * x[i], 1e-10);
    }
  }
}

TEST(Snake, TensionShrinksACircleAsInTheClosedForm) {
  auto settings = only(0.8, 0, 0);
  settings.max_iterations = 600;
  const auto found = evolve_snake(circle(middle, 20, 100), flat_edges(), settings);
  EXPECT_NEAR(radius_of(found.curve), std::sqrt(20 * 20 - 2 * 0.8 * found.time), 0.02);
  EXPECT_LT(radius_of(found.curve), 17);
}

TEST(Snake, RigidityShrinksACircleAsInTheClosedForm) {
  auto settings = only(0, 30, 0);
  settings.max_iterations = 20000;
  const auto found = evolve_snake(circle(middle, 12, 80), flat_edges(), settings);
  EXPECT_NEAR(radius_of(found.curve), std::pow(std::pow(12, 4) - 4 * 30 * found.time, 0.25), 0.02);
  EXPECT_LT(radius_of(found.curve), 11.5);
}

TEST(Snake, BalloonGrowsAtItsSpeed) {
  auto settings = only(0, 0, 1);
  settings.max_iterations = 40;
  const auto found = evolve_snake(circle(middle, 8, 60), flat_edges(), settings);
  EXPECT_NEAR(radius_of(found.curve), 8 + found.time, 0.02);
  EXPECT_NEAR(found.time, 10, 1e-9);
}

TEST(Snake, ResamplingKeepsTheShape) {
  Curve curve = circle(middle, 15, 120);
  for (std::size_t i = 0; i < curve.size(); ++i) curve[i].x += 4 * std::sin(0.05 * static_cast<double>(i));
  const double area = area_mm2(curve);
  for (int n = 0; n < 500; ++n) curve = resampled(curve, 90 + n % 7);
  EXPECT_NEAR(area_mm2(curve) / area, 1, 2e-3);
  const double spacing = length_mm(curve) / static_cast<double>(curve.size());
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const Point2 &a = curve[i], &b = curve[(i + 1) % curve.size()];
    EXPECT_NEAR(std::hypot(b.x - a.x, b.y - a.y) / spacing, 1, 0.05);
  }
}

TEST(Snake, SettlesOnTheEdgeOfADisc) {
  const auto grid = grid_of({64, 64, 1});
  const auto disc = volume_of(grid, [](double x, double y, double) {
    return std::clamp(13.3 - length(x, y) + 0.5, 0.0, 1.0);  // partial volume
  });
  const auto h = edges_of(noisy(disc, 0.05), {1, 0.05});
  for (const double start : {10.0, 17.0}) {
    SnakeSettings settings;
    settings.balloon = start < 13 ? 0.3 : 0;
    const auto found = evolve_snake(circle(middle, start, 60), h, settings);
    EXPECT_EQ(found.end, SnakeEnd::settled) << name_of(found.end);
    EXPECT_NEAR(radius_of(found.curve), 13.3, 0.4);
    EXPECT_FALSE(crosses_itself(found.curve));
  }
}

TEST(Snake, SaysWhyItFoundNothing) {
  SnakeSettings settings;
  EXPECT_EQ(evolve_snake(circle(middle, 10, 60), flat_edges(), settings).end, SnakeEnd::collapsed);
  settings.balloon = 2;
  EXPECT_EQ(evolve_snake(circle(middle, 10, 60), flat_edges(), settings).end, SnakeEnd::left_the_image);
}

TEST(Snake, CrossingsAndTheInside) {
  Curve eight;
  for (int i = 0; i < 60; ++i)
    eight.push_back({30 + 12 * std::sin(pi * i / 30 + 0.05), 30 + 6 * std::sin(pi * i / 15 + 0.1)});
  EXPECT_TRUE(crosses_itself(eight));
  const Curve round = circle(middle, 14.2, 300);
  EXPECT_FALSE(crosses_itself(round));
  auto grid = grid_of({128, 64, 1}, {0.5, 1, 1});
  const Mask inside = inside_of(round, grid);
  const auto pixels = static_cast<double>(std::count(inside.voxels.begin(), inside.voxels.end(), 1));
  EXPECT_NEAR(0.5 * pixels, area_mm2(round), 0.01 * area_mm2(round));
}

TEST(Snake, MistakesAreUserErrors) {
  const auto h = flat_edges();
  EXPECT_THROW(evolve_snake(circle(middle, 5, 7), h, {}), UserError);
  EXPECT_THROW(evolve_snake(circle(middle, 5, 30), Volume<float>(grid_of({9, 9, 9}), 1), {}), UserError);
  EXPECT_THROW(evolve_snake(circle(middle, 5, 30), h, only(-1, 0, 0)), UserError);
}

}  // namespace
}  // namespace heartgen
