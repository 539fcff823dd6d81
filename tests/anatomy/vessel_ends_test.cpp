// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/vessel_ends.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/places.hpp"

namespace heartgen::anatomy {
namespace {

TEST(CutVenaeCavae, TheyGoAndTheRestStays) {
  Grid grid;
  grid.size = {60, 60, 90};
  grid.origin_mm = {-30, -30, -45};
  Mask atrium(grid);
  const auto in_tube = [](const Vec3& p, double x, double y) { return std::hypot(p.x - x, p.y - y) < 7; };
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Vec3 p = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const bool cavae = in_tube(p, 0, 8);                               // above and below, behind
        const bool appendage = in_tube(p, 0, -10) && p.z > 0 && p.z < 30;  // above, in front
        atrium.voxels[v] = norm(p) < 20 || cavae || appendage;
      }
  const Mask cut = anatomy::cut_venae_cavae(atrium, 0.6, 1.5);
  const auto at = [&](double x, double y, double z) {
    const Vec3 index = index_from_lps(grid, {x, y, z});
    return cut(std::lround(index.x), std::lround(index.y), std::lround(index.z)) != 0;
  };
  for (const double way : {-1, 1}) {  // the ball's section is as large as the vein's beside it at 18 mm
    EXPECT_TRUE(at(0, 8, way * 26));
    EXPECT_FALSE(at(0, 8, way * 31));
  }
  EXPECT_TRUE(at(0, -10, 29));
}

/// A larger column behind the atrium that hangs together with the vein, as the spine can through the liver.
TEST(CutVenaeCavae, TheSpineIsNoVein) {
  Grid grid;
  grid.size = {60, 100, 90};
  grid.origin_mm = {-30, -30, -60};
  Mask atrium(grid);
  for (std::size_t v = 0; v < atrium.voxels.size(); ++v) {
    const Vec3 p = testing::lps_of_voxel(grid, static_cast<std::int64_t>(v));
    const bool vein = std::hypot(p.x, p.y - 8) < 7 && p.z < 0;
    const bool spine = std::hypot(p.x, p.y - 55) < 13 && p.z < 20;
    const bool bridge = std::abs(p.x) < 5 && p.y > 8 && p.y < 55 && p.z < -45 && p.z > -52;
    atrium.voxels[v] = norm(p) < 20 || vein || spine || bridge;
  }
  const Mask cut = anatomy::cut_venae_cavae(atrium, 0.6, 1.5);
  const auto at = [&](double x, double y, double z) {
    const Vec3 index = index_from_lps(grid, {x, y, z});
    return cut(std::lround(index.x), std::lround(index.y), std::lround(index.z)) != 0;
  };
  EXPECT_TRUE(at(0, 8, -26));
  EXPECT_FALSE(at(0, 8, -31));
  EXPECT_FALSE(at(0, 55, -26));
}

/// Veins that lean by 27 degrees: their ends are perpendicular to them, not level.
TEST(CutVenaeCavae, EndsArePerpendicularToTheVein) {
  Grid grid;
  grid.size = {60, 80, 120};
  grid.origin_mm = {-30, -40, -60};
  const Vec3 axis = normalized({0, 0.5, 1});
  Mask atrium(grid);
  const auto at = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
  };
  for (std::int64_t k = 0; k < 120; ++k)
    for (std::int64_t j = 0; j < 80; ++j)
      for (std::int64_t i = 0; i < 60; ++i) {
        const Vec3 p = at(i, j, k);
        atrium(i, j, k) = norm(p) < 20 || norm(p - dot(p, axis) * axis) < 8;
      }
  const Mask cut = anatomy::cut_venae_cavae(atrium, 0.6, 1.5);
  // Through the ball's middle the section is twice the vein's where the ball's is: sqrt(20² - 2 * 8²) mm along the
  // axis.
  const double end_mm = std::sqrt(20 * 20 - 2 * 8 * 8) + 1.5 * 8;
  std::int64_t wrong = 0;
  for (std::int64_t k = 0; k < 120; ++k)
    for (std::int64_t j = 0; j < 80; ++j)
      for (std::int64_t i = 0; i < 60; ++i) {
        const double along = dot(at(i, j, k), axis);
        wrong += atrium(i, j, k) && (std::abs(along) < end_mm) != (cut(i, j, k) != 0);
      }
  EXPECT_LT(wrong, 400);  // 1 mm of each end
}

}  // namespace
}  // namespace heartgen::anatomy
