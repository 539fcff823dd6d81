// SPDX-License-Identifier: GPL-3.0-or-later
// The analytic fibres of the phantom: unit vectors in the wall whose helix angle falls from +60 to -60 degrees.
#include <gtest/gtest.h>

#include <cmath>

#include "datasets/phantom/anatomy.hpp"
#include "datasets/survey.hpp"
#include "support/places.hpp"

namespace heartgen::phantom {
namespace {

/// Signed helix angle (deg) of an axis: positive where it rises to the base while turning counter-clockwise seen from
/// the base around `center`.
double helix_deg(const Vec3& fiber, const Vec3& p, const Vec3& center, const Vec3& axis) {
  const Vec3 radial = (p - center) - dot(p - center, axis) * axis;
  const Vec3 around = normalized(cross(axis, radial));
  double a = dot(fiber, around), l = dot(fiber, axis);
  if (a < 0) a = -a, l = -l;
  return std::atan2(l, a) * 180 / 3.14159265358979323846;
}

TEST(Fibers, AreUnitVectorsInEveryMuscleVoxelButThoseOfTheFibrousPlates) {
  const auto model = make_heart_model(2);
  const auto labels = survey_heart(model, 3).regions;
  const Grid& grid = labels.grid;
  int muscle = 0, fibrous = 0, other = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const auto region = static_cast<Region>(labels(i, j, k));
        if (region != Region::lv_myocardium && region != Region::rv_myocardium && region != Region::papillary) continue;
        ++muscle;
        const Vec3 p = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const double depth = depth_at(model, p);
        fibrous += std::isnan(depth);
        EXPECT_NEAR(norm(fiber_at(model, p)), std::isnan(depth) ? 0 : 1, 1e-9);
        EXPECT_TRUE(std::isnan(depth) || (depth >= 0 && depth <= 1));
        const Region taken_for = muscle_of_fiber_at(model, p);
        EXPECT_EQ(taken_for == Region::none, std::isnan(depth));
        other += !std::isnan(depth) && taken_for != region;
      }
  EXPECT_LT(other, 0.01 * muscle);
  EXPECT_GT(muscle, 3000);
  EXPECT_LT(fibrous, 0.08 * muscle);
}

TEST(Fibers, DepthRunsFromZeroToOneBetweenTheSurfacesThatTheMuscleHas) {
  const auto model = make_heart_model();
  const Vec3 axis = long_axis(model), apex = *landmarks_of(model).lv_apex_mm;
  // Across the septum just below the aortic valve the cavity is the outflow tract, not the ellipsoid behind it.
  const auto valve = landmarks_of(model).valves.at("aortic");
  const Vec3 center = valve.center_mm - 6 * valve.normal;
  const Vec3 to_right = landmarks_of(model).seeds_mm.at("rv_blood") - apex;
  const Vec3 outwards = normalized(to_right - dot(to_right, axis) * axis);
  double first = -1, last = -1;
  for (const double r : testing::steps(5, 30, 0.1)) {
    const Vec3 p = center + r * outwards;
    const Region region = region_at(model, p);
    if (region != Region::lv_myocardium && last >= 0) break;
    if (region != Region::lv_myocardium) continue;
    last = depth_at(model, p);
    if (first < 0) first = last;
  }
  EXPECT_NEAR(first, 0, 0.15);
  EXPECT_NEAR(last, 1, 0.25);
}

TEST(Fibers, HelixFallsLinearlyThroughTheLateralWall) {
  const auto model = make_heart_model();
  const auto marks = landmarks_of(model);
  const Vec3 axis = long_axis(model);
  const Vec3 center = *marks.lv_apex_mm + 66 * axis;  // near the equator
  const Vec3 outwards =
      normalized(cross(axis, cross(Vec3{1, 0.8, 0}, axis)));  // to the left and back: the lateral wall
  int samples = 0;
  for (const double r : testing::steps(15, 45, 0.25)) {
    const Vec3 p = center + r * outwards;
    if (region_at(model, p) != Region::lv_myocardium) continue;
    const double depth = depth_at(model, p);
    if (depth <= 0.02 || depth >= 0.98) continue;
    ++samples;
    EXPECT_NEAR(helix_deg(fiber_at(model, p), p, center, axis), 60 - 120 * depth, 2) << "at depth " << depth;
  }
  EXPECT_GT(samples, 25);
}

TEST(Fibers, RightVentricleFollowsTheSameRule) {
  const auto model = make_heart_model();
  const auto marks = landmarks_of(model);
  const Vec3 axis = long_axis(model), seed = marks.seeds_mm.at("rv_blood");
  Vec3 outwards = seed - marks.seeds_mm.at("lv_blood");
  outwards = normalized(outwards - dot(outwards, axis) * axis);
  double first = 0, last = 0;
  for (const double r : testing::steps(0, 30, 0.2)) {
    const Vec3 p = seed + r * outwards;
    if (region_at(model, p) != Region::rv_myocardium) continue;
    const double angle = helix_deg(fiber_at(model, p), p, marks.seeds_mm.at("lv_blood"), axis);
    if (first == 0) first = angle;
    last = angle;
  }
  EXPECT_GT(first, 35);
  EXPECT_LT(last, -35);
}

TEST(Fibers, RightWallHasItsSurfacesWhereTheLabelsHaveThemAlsoAroundTheInflow) {
  for (const int variant : {0, 1, 2}) {
    const auto model = make_heart_model(variant);
    const auto valve = landmarks_of(model).valves.at("tricuspid");
    const Vec3 first_side = normalized(cross(valve.normal, long_axis(model) + Vec3{0.3, 0, 0.2}));
    int walls = 0;
    for (int turn = 0; turn < 24; ++turn) {
      const double angle = turn * 3.14159265358979323846 / 12;
      const Vec3 side = std::cos(angle) * first_side + std::sin(angle) * cross(valve.normal, first_side);
      double first = -1, last = -1;
      Region next = Region::none;
      for (const double r : testing::steps(0.9 * valve.radius_mm, valve.radius_mm + 9, 0.05)) {
        const Vec3 p = valve.center_mm - 5 * valve.normal + r * side;
        next = region_at(model, p);
        if (next == Region::rv_myocardium) {
          last = depth_at(model, p);
          if (first < 0) first = last;
        } else if (last >= 0) {
          break;
        }
      }
      // Where the wall meets the left one it does not end at a surface of its own.
      if (last < 0 || next == Region::rv_myocardium || next == Region::lv_myocardium || next == Region::rv_blood)
        continue;
      ++walls;
      EXPECT_NEAR(first, 0, 0.03) << "variant " << variant << ", turn " << turn;
      EXPECT_NEAR(last, 1, 0.03) << "variant " << variant << ", turn " << turn;
    }
    EXPECT_GT(walls, 4);
  }
}

TEST(Fibers, TheRegionalFieldIsDefinedWhereTheUniformOneIsAndDepartsFromItByRegion) {
  const auto model = make_heart_model();
  const auto labels = survey_heart(model, 4).regions;
  double least = 90, most = -90;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    if (labels.voxels[v] != tag(Region::lv_myocardium) && labels.voxels[v] != tag(Region::rv_myocardium)) continue;
    const Vec3 p = testing::lps_of_voxel(labels.grid, static_cast<std::int64_t>(v));
    const Vec3 uniform = fiber_at(model, p), regional = fiber_at(model, p, HelixField::regional);
    ASSERT_EQ(norm(uniform) > 0.5, norm(regional) > 0.5);
    if (norm(uniform) < 0.5) continue;
    ASSERT_NEAR(norm(regional), 1, 1e-9);
    const double turn = std::acos(std::min(1.0, std::abs(dot(uniform, regional)))) * 180 / 3.14159265358979323846;
    least = std::min(least, turn);
    most = std::max(most, turn);
  }
  EXPECT_LT(least, 1);
  EXPECT_GT(most, 20);
  EXPECT_LT(most, 45);
}

TEST(Fibers, VanishFarFromTheHeart) {
  const auto model = make_heart_model();
  EXPECT_EQ(fiber_at(model, {-120, 40, 60}), (Vec3{}));
  EXPECT_TRUE(std::isnan(depth_at(model, {-120, 40, 60})));
}

}  // namespace
}  // namespace heartgen::phantom
