// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of labels as even as these ask for, against spheres and the groove between two half spaces.
#include "generator/ventricles/regularized_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "datasets/phantom/shapes.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/image/resample.hpp"
#include "generator/ventricles/compact_wall.hpp"

namespace heartgen {
namespace {

constexpr Vec3 middle_mm{40.3, 39.8, 40.1};
constexpr double default_smoothing_voxels = 2.2;  // what evens out the steps of exact labels

using Inside = std::function<bool(const Vec3& from_middle, std::size_t voxel)>;

Grid cube(std::int64_t size) {
  Grid grid;
  grid.size = {size, size, size};
  return grid;
}

Mask filled(const Inside& inside) {
  Mask mask(cube(81));
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    mask.voxels[v] = inside(image::voxel_center(mask.grid, static_cast<std::int64_t>(v)) - middle_mm, v);
  return mask;
}

/// Smooth random values of standard deviation 0.4.
Volume<float> lumps(double smoothing_voxels) {
  Volume<float> field(cube(81));
  for (std::size_t v = 0; v < field.voxels.size(); ++v)
    field.voxels[v] = static_cast<float>(phantom::random_symmetric(5, v));
  field = image::smoothed(field, smoothing_voxels);
  double squares = 0;
  for (const float x : field.voxels) squares += double{x} * x;
  const double scale = 0.4 / std::sqrt(squares / static_cast<double>(field.voxels.size()));
  for (float& x : field.voxels) x = static_cast<float>(scale * x);
  return field;
}

/// Root mean square distance of a surface from the sphere that it should be.
double off_sphere_mm(const LevelSet& surface, double radius_mm) {
  double squares = 0;
  constexpr int count = 2000;
  for (int n = 0; n < count; ++n) {
    const double z = -1 + 2 * (n + 0.5) / count, angle = 2.39996 * n, across = std::sqrt(1 - z * z);
    const Vec3 direction{across * std::cos(angle), across * std::sin(angle), z};
    const double d = ventricles::distance_along_gradient(surface, middle_mm + radius_mm * direction);
    squares += d * d / count;
  }
  return std::sqrt(squares);
}

TEST(EvenSurface, LumpsOfLabelsAreTakenAway) {
  constexpr double radius_mm = 28;
  const auto lump = lumps(2);
  const Mask sphere = filled([&](const Vec3& d, std::size_t v) { return norm(d) < radius_mm + lump.voxels[v]; });
  const double usual = off_sphere_mm(image::signed_distance(sphere, default_smoothing_voxels), radius_mm);
  const double even = off_sphere_mm(ventricles::regularized_surface(sphere, Mask(sphere.grid, 1), 1), radius_mm);
  EXPECT_LT(even, 0.75 * usual) << usual;
}

TEST(EvenSurface, AnExactSphereStaysWhereItIs) {
  constexpr double radius_mm = 28;
  const Mask sphere = filled([&](const Vec3& d, std::size_t) { return norm(d) < radius_mm; });
  const double usual = off_sphere_mm(image::signed_distance(sphere, default_smoothing_voxels), radius_mm);
  const double even = off_sphere_mm(ventricles::regularized_surface(sphere, Mask(sphere.grid, 1), 1), radius_mm);
  EXPECT_LT(even, usual + 0.005);
  EXPECT_LT(even, 0.05);
  const auto seeing = ventricles::regularized_surface(image::signed_distance(sphere, 0), Mask(sphere.grid, 1), 1,
                                                      {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  EXPECT_LT(off_sphere_mm(seeing, radius_mm), 0.05);
}

/// Mean distance of a groove's bottom from where it should be.
double off_groove_mm(const LevelSet& surface, const Vec3& line) {
  double sum = 0;
  for (int n = -10; n <= 10; ++n)
    sum += std::abs(ventricles::distance_along_gradient(surface, middle_mm + 0.8 * n * line)) / 21;
  return sum;
}

TEST(EvenSurface, AGrooveKeepsItsBottom) {
  const Vec3 a = normalized({1, 0.4, 0.3}), line = normalized(cross(a, {0.2, 1, -0.5})), b = cross(line, a);
  const Mask groove = filled([&](const Vec3& d, std::size_t) { return dot(d, a) < 0 || dot(d, b) < 0; });
  const Mask own = filled([&](const Vec3& d, std::size_t) { return std::max(dot(d, a), dot(d, b)) > 14; });
  const double usual = off_groove_mm(image::signed_distance(groove, default_smoothing_voxels), line);
  const double even = off_groove_mm(ventricles::regularized_surface(groove, own, 1), line);
  EXPECT_GT(usual, 0.5);
  EXPECT_LT(even, 0.8 * usual) << usual;
}

/// Root mean square distance of the flat top of an ellipsoid of revolution from where it should be.
double off_top_mm(const LevelSet& surface, double across_mm, double along_mm) {
  double squares = 0;
  int count = 0;
  for (int j = -12; j <= 12; ++j)
    for (int i = -12; i <= 12; ++i, ++count) {
      const Vec3 d{i + 0.3, j + 0.2, 0};
      const double z = along_mm * std::sqrt(1 - dot(d, d) / (across_mm * across_mm));
      const double off = ventricles::distance_along_gradient(surface, middle_mm + d + Vec3{0, 0, z});
      squares += off * off;
    }
  return std::sqrt(squares / count);
}

TEST(EvenSurface, TerracesOfWideSlicesAreNoShape) {
  constexpr double across_mm = 36, along_mm = 22, slice_mm = 2;
  const auto depth = [](const Vec3& d) {
    return (d.x * d.x + d.y * d.y) / (across_mm * across_mm) + d.z * d.z / (along_mm * along_mm);
  };
  const Mask sliced = filled([&](const Vec3& d, std::size_t) {
    return depth({d.x, d.y, slice_mm * std::round(d.z / slice_mm)}) < 1;
  });
  const auto distance = image::signed_distance(sliced, 0);
  const Mask own(sliced.grid, 1);
  const double blind = off_top_mm(ventricles::regularized_surface(distance, own, 1), across_mm, along_mm);
  const ventricles::LabelSteps steps_mm{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, slice_mm}};
  const double seeing = off_top_mm(ventricles::regularized_surface(distance, own, 1, steps_mm), across_mm, along_mm);
  EXPECT_LT(seeing, 0.9 * blind) << blind;
}

TEST(EvenSurface, CoarseLabelsAndEmptyMasksAreSmoothedAsFarAsWallsBend) {
  const Mask sphere = filled([&](const Vec3& d, std::size_t) { return norm(d) < 28; });
  const auto coarse = ventricles::regularized_surface(sphere, Mask(sphere.grid), 9);
  EXPECT_LT(off_sphere_mm(coarse, 28), 0.2);
  const auto nothing = ventricles::regularized_surface(Mask(cube(20)), Mask(cube(20)), 1);
  EXPECT_GT(nothing(10, 10, 10), 100);
}

}  // namespace
}  // namespace heartgen
