// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/flood.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "generator/anatomy/vessel_ends.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/morphology.hpp"

namespace heartgen::anatomy {
namespace {

Grid grid_of_mm() {
  Grid grid;
  grid.size = {64, 32, 32};
  grid.origin_mm = {-31.5, -15.5, -15.5};
  return grid;
}

template <class Rule>
Mask where(const Grid& grid, Rule rule) {
  Mask mask(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        mask(i, j, k) =
            rule(lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
  return mask;
}

/// Two balls joined by a neck.
Mask dumbbell(double neck_radius) {
  return where(grid_of_mm(), [&](const Vec3& p) {
    return norm(p - Vec3{-14, 0, 0}) < 13 || norm(p - Vec3{14, 0, 0}) < 13 ||
           (std::abs(p.x) < 14 && std::hypot(p.y, p.z) < neck_radius);
  });
}

Volume<float> depth_of(const Mask& mask) {
  Mask outside(mask.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) outside.voxels[v] = mask.voxels[v] == 0;
  return image::distance_to(outside);
}

TEST(Flood, LinesFallOnTheNeck) {
  const Mask mask = dumbbell(4);
  const auto labels = image::flood_from_markers(mask, depth_of(mask), {{1, {14, 16, 16}}, {2, {48, 16, 16}}},
                                                image::ValveBarrier(mask.grid));
  std::size_t v = 0;
  for (std::int64_t k = 0; k < 32; ++k)
    for (std::int64_t j = 0; j < 32; ++j)
      for (std::int64_t i = 0; i < 64; ++i, ++v) {
        const double x = static_cast<double>(i) - 31.5;
        const int side = x < -5 ? 1 : x > 5 ? 2 : 0;
        EXPECT_EQ(labels.voxels[v] != 0, mask.voxels[v] != 0);
        if (mask.voxels[v] && side != 0) {
          EXPECT_EQ(labels.voxels[v], side);
        }
      }
}

TEST(Flood, ADiscIsNeverCrossed) {
  const Mask mask = where(grid_of_mm(), [](const Vec3& p) { return std::hypot(p.y, p.z) < 8; });  // no constriction
  Landmarks landmarks;
  landmarks.valves["mitral"] = {{6, 0, 0}, {0.9, 0.3, 0.2}, 9};
  const auto labels = image::flood_from_markers(mask, depth_of(mask), {{1, {2, 16, 16}}, {2, {62, 16, 16}}},
                                                image::valve_barrier(mask.grid, landmarks, 2));
  std::size_t v = 0;
  const Vec3 normal = normalized({0.9, 0.3, 0.2});
  for (std::int64_t k = 0; k < 32; ++k)
    for (std::int64_t j = 0; j < 32; ++j)
      for (std::int64_t i = 0; i < 64; ++i, ++v) {
        if (!mask.voxels[v]) continue;
        const Vec3 at =
            lps_from_index(mask.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        EXPECT_EQ(labels.voxels[v], dot(at - Vec3{6, 0, 0}, normal) >= 0 ? 2 : 1);
      }
}

TEST(Flood, GeodesicDistanceFollowsTheInside) {
  // A U: two arms along x joined at the right end.
  const Mask mask = where(grid_of_mm(), [](const Vec3& p) {
    return std::abs(p.z) < 2 && (std::abs(std::abs(p.y) - 8) < 2 || (p.x > 20 && std::abs(p.y) < 8));
  });
  const Mask start = where(grid_of_mm(), [](const Vec3& p) { return p.x < -30 && p.y > 0; });
  const auto way = image::geodesic_distance(mask, start, 1e6);
  const float end = way(1, 8, 16);  // the other arm's end: 16 mm away, about 120 mm along the inside
  EXPECT_GT(end, 105);
  EXPECT_LT(end, 135);
  EXPECT_TRUE(std::isinf(image::geodesic_distance(mask, start, 50)(1, 8, 16)));
}

TEST(VesselEnds, AnArteryEndsInAPlaneAcrossItsAxis) {
  const Vec3 axis = normalized({1, 0.15, -0.1});
  const Mask artery = where(grid_of_mm(), [&](const Vec3& p) { return norm(p - dot(p, axis) * axis) < 6; });
  const Mask start = where(grid_of_mm(), [](const Vec3& p) { return p.x < -31; });
  const Mask cut = anatomy::cut_artery(artery, start, 40);
  double highest = -100, lowest_left_out = 100;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < 32; ++k)
    for (std::int64_t j = 0; j < 32; ++j)
      for (std::int64_t i = 0; i < 64; ++i, ++v) {
        if (!artery.voxels[v]) continue;
        const double along =
            dot(lps_from_index(artery.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}),
                axis);
        if (cut.voxels[v])
          highest = std::max(highest, along);
        else
          lowest_left_out = std::min(lowest_left_out, along);
      }
  EXPECT_NEAR(highest, 8.5, 3);
  EXPECT_GT(lowest_left_out, highest - 2.5);  // flat: nothing left out lies deeper than the plane's thickness
}

TEST(VesselEnds, VeinsBecomeStumpsAndThinBranchesGo) {
  const Mask chamber = where(grid_of_mm(), [](const Vec3& p) {
    return norm(p - Vec3{-14, 0, 0}) < 13 || (p.x > -14 && std::hypot(p.y, p.z) < 4) ||
           (p.x < -10 && std::hypot(p.y - 11, p.z) < 1.5);
  });
  const Mask cut = anatomy::cut_veins(chamber, 0.6, 10);
  EXPECT_EQ(cut(34, 16, 16), 1);  // x = 2.5: 3.5 mm from the ball
  EXPECT_EQ(cut(50, 16, 16), 0);
  const Mask bare = anatomy::drop_thin_branches(cut, 2.5);
  EXPECT_EQ(bare(1, 26, 16), 0);
  EXPECT_EQ(bare(18, 16, 16), 1);
}

}  // namespace
}  // namespace heartgen::anatomy
