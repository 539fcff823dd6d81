// SPDX-License-Identifier: GPL-3.0-or-later
// What lies beyond the lungs: a chest of an elliptic wall around two lungs with a heart between them that bulges into
// the wall.
#include "generator/anatomy/chest_wall.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "generator/image/convex_slices.hpp"
#include "support/places.hpp"

namespace heartgen::anatomy {
namespace {

struct Chest {
  Volume<float> hu;
  Mask heart, wall;
};

/// Axis half-lengths of 110 and 70 mm inside a wall of 15 mm; lungs from 3 to 12 cm above the lowest slice.
Chest chest() {
  const Vec3 heart{15, -40, 75};
  Grid grid;
  grid.size = {140, 100, 70};
  grid.spacing_mm = {2, 2, 2};
  grid.origin_mm = {-140, -100, 0};
  Chest chest{Volume<float>(grid), Mask(grid), Mask(grid)};
  for (std::size_t v = 0; v < chest.hu.voxels.size(); ++v) {
    const Vec3 p = testing::lps_of_voxel(grid, static_cast<std::int64_t>(v));
    const double inside = std::hypot(p.x / 110, p.y / 70), skin = std::hypot(p.x / 125, p.y / 85);
    chest.heart.voxels[v] = norm(p - heart) < 40;  // 10 mm into the wall
    chest.wall.voxels[v] = inside > 1 && skin < 1 && !chest.heart.voxels[v];
    const bool lung = inside < 1 && p.z > 30 && p.z < 120 && std::abs(p.x - 10) > 25;
    chest.hu.voxels[v] = skin > 1 ? -1000.0F : lung && norm(p - heart) > 44 ? -850.0F : 50.0F;
  }
  return chest;
}

TEST(ConvexSlices, FillTheHullOfEverySlice) {
  Grid grid;
  grid.size = {20, 20, 2};
  grid.spacing_mm = {1, 1, 1};
  Mask mask(grid);
  mask(2, 2, 0) = mask(17, 2, 0) = mask(2, 17, 0) = 1;
  const Mask hull = image::convex_slices(mask, 0);
  for (std::int64_t j = 0; j < 20; ++j)
    for (std::int64_t i = 0; i < 20; ++i) {
      EXPECT_EQ(hull(i, j, 0) != 0, i >= 2 && j >= 2 && i + j <= 19) << i << ' ' << j;
      EXPECT_EQ(hull(i, j, 1), 0);
    }
}

TEST(ChestWall, LiesBeyondTheLungsAndTheHeartDoesNot) {
  const Chest c = chest();
  const Mask beyond = anatomy::beyond_the_lungs(anatomy::lungs_of(c.hu));
  std::int64_t of_heart = 0, wall = 0, found = 0;
  for (std::size_t v = 0; v < beyond.voxels.size(); ++v) {
    const Vec3 p = testing::lps_of_voxel(c.hu.grid, static_cast<std::int64_t>(v));
    of_heart += beyond.voxels[v] && c.heart.voxels[v];
    if (!c.wall.voxels[v] || p.z < 32 || p.z > 118) continue;
    if (std::abs(p.x) < 60) continue;  // in the middle the hull ends in no lung
    ++wall;
    found += beyond.voxels[v];
  }
  EXPECT_EQ(of_heart, 0);
  EXPECT_GT(wall, 0);
  EXPECT_GT(static_cast<double>(found), 0.95 * static_cast<double>(wall));
}

TEST(ChestWall, NothingIsSaidWhereNoLungIs) {
  const Chest c = chest();
  const Mask beyond = anatomy::beyond_the_lungs(anatomy::lungs_of(c.hu));
  for (std::size_t v = 0; v < beyond.voxels.size(); ++v) {
    const Vec3 p = testing::lps_of_voxel(c.hu.grid, static_cast<std::int64_t>(v));
    if (p.z >= 30 && p.z <= 120 && std::abs(p.x - 10) >= 15) continue;
    ASSERT_EQ(beyond.voxels[v], 0) << p.x << ' ' << p.y << ' ' << p.z;
  }
  Volume<float> no_lung = c.hu;
  for (float& hu : no_lung.voxels)
    if (hu == -850.0F) hu = 50;
  for (const auto voxel : anatomy::beyond_the_lungs(anatomy::lungs_of(no_lung)).voxels) ASSERT_EQ(voxel, 0);
}

}  // namespace
}  // namespace heartgen::anatomy
