// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of labels that are finer than the grid, against a sphere and a tilted plane.
#include "generator/image/subvoxel_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "generator/image/isotropic_distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/resample.hpp"

namespace heartgen {
namespace {

constexpr Vec3 middle_mm{20.3, 19.8, 20.1};

Grid cube(std::int64_t size, double spacing_mm) {
  Grid grid;
  grid.size = {size, size, size};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  return grid;
}

using Distance = std::function<double(const Vec3&)>;

/// Labels 1 inside, on voxels of 0.5 mm.
LabelVolume fine_labels(const Distance& distance) {
  LabelVolume labels(cube(82, 0.5));
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    labels.voxels[v] = distance(image::voxel_center(labels.grid, static_cast<std::int64_t>(v))) < 0;
  return labels;
}

/// Root mean square error of a distance within `reach_mm` of its surface, clear of the image's border.
double error_mm(const LevelSet& found, const Distance& distance, double reach_mm) {
  double squares = 0, count = 0;
  for (std::size_t v = 0; v < found.voxels.size(); ++v) {
    const Vec3 p = image::voxel_center(found.grid, static_cast<std::int64_t>(v));
    const Vec3 d = p - middle_mm;
    if (std::abs(distance(p)) > reach_mm || std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) > 15) continue;
    squares += std::pow(found.voxels[v] - distance(p), 2);
    ++count;
  }
  return std::sqrt(squares / count);
}

/// Errors of a distance from a mask alone and from it with shares.
struct Errors {
  double mask_mm = 0, share_mm = 0;
};

Errors errors_of(const Distance& distance, double reach_mm) {
  const Grid grid = cube(41, 1);
  const auto shares = image::shares_on(fine_labels(distance), grid);
  const auto found = image::largest_share(shares, grid);
  const Mask inside = image::mask_where(found, [](auto label) { return label == 1; });
  return {error_mm(image::signed_distance(inside, 0), distance, reach_mm),
          error_mm(image::signed_distance(inside, shares.at(1)), distance, reach_mm)};
}

TEST(ShareDistance, ASurfaceLiesWhereFineLabelsHaveIt) {
  const Vec3 normal = normalized({1, 0.08, -0.05});  // steps of voxels are many voxels long
  for (const Distance& distance : {Distance([](const Vec3& p) { return norm(p - middle_mm) - 12.2; }),
                                   Distance([&](const Vec3& p) { return dot(p - middle_mm, normal) - 0.2; })}) {
    const auto near = errors_of(distance, 1), far = errors_of(distance, 5);
    // The fine labels' own steps leave 0.5 mm / sqrt(12) = 0.144 mm, those of the grid 0.289 mm.
    EXPECT_LT(near.share_mm, 0.6 * near.mask_mm) << near.mask_mm;
    EXPECT_LT(far.share_mm, 0.8 * far.mask_mm) << far.mask_mm;
  }
}

TEST(ShareDistance, WhatThePartsMadeUpKeepsItsMask) {
  const Grid grid = cube(24, 1);
  Mask inside(grid);
  Volume<float> share(grid);
  for (std::int64_t k = 0; k < 24; ++k)
    for (std::int64_t j = 0; j < 24; ++j)
      for (std::int64_t i = 0; i < 24; ++i) {
        inside(i, j, k) = i < 12;
        share(i, j, k) = i < 8 ? 1.0F : 0.0F;  // the labels ended four voxels below
      }
  const auto plain = image::signed_distance(inside, 0), kept = image::signed_distance(inside, share);
  EXPECT_EQ(plain.voxels, kept.voxels);
  EXPECT_EQ(plain.voxels, image::signed_distance(inside, Volume<float>{}).voxels);
}

}  // namespace
}  // namespace heartgen
