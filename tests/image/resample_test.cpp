// SPDX-License-Identifier: GPL-3.0-or-later
// Labels on another grid: no beats between the two.
#include "generator/image/resample.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "generator/image/isotropic_distance.hpp"

namespace heartgen {
namespace {

Grid cube(double spacing_mm, double from_mm, std::int64_t count) {
  Grid grid;
  grid.size = {count, count, count};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  grid.origin_mm = {from_mm, from_mm, from_mm};
  return grid;
}

LabelVolume resampled(const LabelVolume& labels, const Grid& grid) {
  return image::largest_share(image::shares_on(labels, grid), grid);
}

/// A ball of 18 mm with a wall of 4 mm.
LabelVolume shell(const Grid& grid) {
  LabelVolume labels(grid);
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    const double r = norm(image::voxel_center(grid, static_cast<std::int64_t>(v)) - Vec3{0.31, -0.17, 0.44});
    labels.voxels[v] = r > 18 ? 0 : r > 14 ? 1 : 6;
  }
  return labels;
}

/// How far surfaces stand off on the average over some voxels, root mean square, in voxels.
double long_waves(const LabelVolume& found, const LabelVolume& exact) {
  Volume<float> off(found.grid);
  for (std::size_t v = 0; v < off.voxels.size(); ++v)
    off.voxels[v] = static_cast<float>(found.voxels[v] == 6) - static_cast<float>(exact.voxels[v] == 6);
  off = image::smoothed(off, 1.5);
  double squares = 0, on_surface = 0;
  for (std::size_t v = 0; v < off.voxels.size(); ++v) {
    const double r = norm(image::voxel_center(off.grid, static_cast<std::int64_t>(v)) - Vec3{0.31, -0.17, 0.44});
    if (std::abs(r - 14) > 0.7) continue;
    squares += off.voxels[v] * off.voxels[v];
    on_surface += 1;
  }
  constexpr double step = 0.2660;  // height of the Gaussian: what a shift by one voxel makes of `off`
  return std::sqrt(squares / on_surface) / step;
}

TEST(Resampled, SurfacesHaveNoLongWaves) {
  const Grid grid = cube(1, -22.35, 46);
  const LabelVolume exact = shell(grid);
  for (const double spacing_mm : {0.8, 0.9, 1.1, 1.2}) {
    const auto found = resampled(shell(cube(spacing_mm, -24, static_cast<std::int64_t>(48 / spacing_mm))), grid);
    EXPECT_LT(long_waves(found, exact), 0.14) << spacing_mm;  // without smoothing .15 and .19 at two of them
  }
}

TEST(Resampled, TheSameGridGivesTheSameLabelsButForSingleVoxels) {
  const LabelVolume labels = shell(cube(1, -22.35, 46));
  const auto found = resampled(labels, labels.grid);
  EXPECT_LT(long_waves(found, labels), 0.05);
}

TEST(Resampled, AVoxelThinSheetStaysAndOutsideOfTheLabelsIsNothing) {
  LabelVolume labels(cube(1, 0, 20), 6);
  for (std::int64_t j = 0; j < 20; ++j)
    for (std::int64_t i = 0; i < 20; ++i) labels(i, j, 10) = 1;
  const auto found = resampled(labels, cube(1, -3, 30));
  for (std::int64_t j = 4; j < 22; ++j)
    for (std::int64_t i = 4; i < 22; ++i) {
      EXPECT_EQ(found(i, j, 13), 1);
      EXPECT_EQ(found(i, j, 11), 6);
      EXPECT_EQ(found(i, j, 1), 0);
      EXPECT_EQ(found(i, j, 28), 0);
    }
}

}  // namespace
}  // namespace heartgen
