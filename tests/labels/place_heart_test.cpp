// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/place_heart.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/error.hpp"
#include "model/labels.hpp"

namespace {

using namespace heartgen;
using labels::CommonMark;

AffineMap turn_and_scale(double angle, double scale, const Vec3& shift) {
  const double c = std::cos(angle), s = std::sin(angle);
  AffineMap map;
  map.matrix = {{scale * Vec3{c, -s, 0}, scale * Vec3{s * std::sqrt(0.5), c * std::sqrt(0.5), -std::sqrt(0.5)},
                 scale * Vec3{s * std::sqrt(0.5), c * std::sqrt(0.5), std::sqrt(0.5)}}};
  map.offset_mm = shift;
  return map;
}

std::vector<CommonMark> marks_through(const AffineMap& map) {
  std::vector<CommonMark> marks;
  for (const auto& p : {Vec3{10, 20, 30}, Vec3{-40, 25, 0}, Vec3{5, -30, 60}, Vec3{0, 0, -20}, Vec3{33, 8, 1}})
    marks.push_back({"mark", p, map(p)});
  return marks;
}

TEST(FitTorso, FindsRotationShiftAndScale) {
  for (const double angle : {0.0, 0.5, -1.2}) {
    const auto map = turn_and_scale(angle, 1.15, {100, -50, 12});
    const auto marks = marks_through(map);
    const auto pose = labels::fit_torso(marks, true);
    EXPECT_NEAR(pose.scale, 1.15, 1e-6);
    EXPECT_NEAR(pose.rms_mm, 0, 1e-5);
    const Vec3 p{3, 4, 5};
    EXPECT_NEAR(norm(pose.torso_from_heart(p) - map(p)), 0, 1e-4);
  }
}

TEST(FitTorso, RigidKeepsItsSize) {
  const auto marks = marks_through(turn_and_scale(0.4, 1.2, {0, 0, 40}));
  const auto pose = labels::fit_torso(marks, false);
  EXPECT_NEAR(pose.scale, 1, 1e-9);
  EXPECT_GT(pose.rms_mm, 3) << "a fifth of the marks' extent is left";
  EXPECT_EQ(pose.residual_mm.size(), marks.size());
}

/// A box of `torso` with a heart of three chambers and a wall in it, on a grid with the given spacing.
LabelVolume person(const Vec3& heart_mm, double spacing_mm, std::int64_t size, double heart_radius_mm) {
  Grid grid;
  grid.size = {size, size, size};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  LabelVolume labels(grid);
  const double half = 0.5 * spacing_mm * static_cast<double>(size - 1);
  for (std::int64_t k = 0; k < size; ++k)
    for (std::int64_t j = 0; j < size; ++j)
      for (std::int64_t i = 0; i < size; ++i) {
        const Vec3 p = lps_from_index(grid, {double(i), double(j), double(k)});
        auto& label = labels(i, j, k);
        if (norm(p - Vec3{half, half, half}) < 0.95 * half) label = tag(Region::torso);
        if (p.z < 0.25 * half && label != 0) label = tag(Region::bone);
        const auto ball = [&](const Vec3& off, double radius, Region region) {
          if (norm(p - heart_mm - heart_radius_mm * off) < radius * heart_radius_mm) label = tag(region);
        };
        ball({0, 0, 0}, 1, Region::lv_myocardium);
        ball({0.4, 0, 0}, 0.3, Region::lv_blood);
        ball({-0.4, 0.1, 0}, 0.3, Region::rv_blood);
        ball({0, 0.2, 0.5}, 0.3, Region::la_blood);
      }
  return labels;
}

std::int64_t count(const LabelVolume& labels, Region region) {
  return std::count(labels.voxels.begin(), labels.voxels.end(), tag(region));
}

TEST(PlaceHeart, TheHeartStaysAndTheTorsoComes) {
  const auto heart = person({30, 30, 30}, 1.5, 41, 20);  // 60 mm
  const auto torso = person({70, 60, 62}, 2.5, 49, 22);  // 120 mm, another heart, elsewhere
  const auto marks = labels::common_marks(heart, {}, torso, {});
  ASSERT_EQ(marks.size(), 3U);
  const auto placed = labels::place_heart(heart, torso, labels::fit_torso(marks, false));
  for (const Region region : {Region::lv_myocardium, Region::lv_blood, Region::rv_blood, Region::la_blood})
    EXPECT_EQ(count(placed.labels, region), count(heart, region)) << region_name(tag(region));
  EXPECT_EQ(placed.outside_share, 0);
  EXPECT_EQ(placed.labels.grid.spacing_mm, heart.grid.spacing_mm);
  // Every voxel of the heart is where it was.
  for (std::int64_t v = 0; v < heart.grid.size[0]; ++v) {
    const Vec3 at = lps_from_index(heart.grid, {double(v), 20, 20});
    const Vec3 index = index_from_lps(placed.labels.grid, at);
    const auto label = heart(v, 20, 20);
    if (!is_myocardium(static_cast<Region>(label)) && !is_blood(static_cast<Region>(label))) continue;
    EXPECT_EQ(placed.labels(std::lround(index.x), std::lround(index.y), std::lround(index.z)), label);
  }
  // The torso is whole, at its own size: 2.5 mm voxels against 1.5 mm ones.
  const double whole = static_cast<double>(torso.voxels.size() - static_cast<std::size_t>(count(torso, Region::none)));
  const double now =
      static_cast<double>(placed.labels.voxels.size() - static_cast<std::size_t>(count(placed.labels, Region::none)));
  EXPECT_NEAR(now * 1.5 * 1.5 * 1.5 / (whole * 2.5 * 2.5 * 2.5), 1, 0.01);
}

TEST(PlaceHeart, AHeartOutsideTheBodyIsRefused) {
  const auto heart = person({30, 30, 30}, 1.5, 41, 20), torso = person({60, 60, 60}, 2.5, 49, 22);
  labels::TorsoPose pose;
  pose.torso_from_heart.offset_mm = {90, 30, 30};
  EXPECT_THROW(labels::place_heart(heart, torso, pose), UserError);
}

TEST(CommonMarks, TooFewAreRefused) {
  auto heart = person({30, 30, 30}, 1.5, 41, 20);
  const auto torso = person({60, 60, 60}, 2.5, 49, 22);
  std::replace(heart.voxels.begin(), heart.voxels.end(), tag(Region::la_blood), tag(Region::lv_myocardium));
  EXPECT_THROW(labels::common_marks(heart, {}, torso, {}), UserError);
  Landmarks here, there;
  here.lv_apex_mm = Vec3{30, 45, 20};
  there.lv_apex_mm = Vec3{60, 76, 49};
  EXPECT_EQ(labels::common_marks(heart, here, torso, there).size(), 3U);
}

}  // namespace
