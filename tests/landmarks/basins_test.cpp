// SPDX-License-Identifier: GPL-3.0-or-later
// The pieces of the search that have a closed form: basins, contacts, sections, statistics.
#include "generator/image/basins.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "generator/image/sections.hpp"
#include "generator/image/statistics.hpp"
#include "generator/landmarks/contact.hpp"
#include "generator/landmarks/divide_at_plane.hpp"
#include "generator/landmarks/valve_patch.hpp"

namespace heartgen::landmarks {
namespace {

Grid box_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  Grid grid;
  grid.size = {x, y, z};
  grid.spacing_mm = {chest::working_spacing_mm, chest::working_spacing_mm, chest::working_spacing_mm};
  return grid;
}

/// Two balls of 15 mm, 36 mm apart, joined by a tube.
Mask dumbbell(double tube_radius_mm) {
  const Vec3 a{30, 30, 30}, b{66, 30, 30};
  return chest::mask_where(box_of(64, 41, 41), [&](const Vec3& p, std::size_t) {
    const bool in_tube = p.x > a.x && p.x < b.x && std::hypot(p.y - a.y, p.z - a.z) < tube_radius_mm;
    return norm(p - a) < 15 || norm(p - b) < 15 || in_tube;
  });
}

TEST(Basins, AreDividedAtAConstriction) {
  const auto basins = image::divide_at_constrictions(dumbbell(8));
  ASSERT_EQ(basins.count, 2);
  EXPECT_NEAR(basins.width(1, 2), 8, chest::working_spacing_mm);
  EXPECT_EQ(basins.width(1, 2), basins.width(2, 1));
  EXPECT_NE(basins.label(20, 20, 20), basins.label(44, 20, 20));
  // The line lies in the tube, which is equally wide for 5 mm on both sides of the middle.
  const auto contact = contact_surface(
      basins.label, [](std::int32_t l) { return l == 1; }, [](std::int32_t l) { return l == 2; });
  EXPECT_NEAR(image::mean(contact.points).x, 48, 5);
  EXPECT_NEAR(norm(contact.area_mm2), std::numbers::pi * 64, 0.12 * std::numbers::pi * 64);
}

TEST(Basins, AreOneWhereTheWayIsAsWideAsThemselves) {
  EXPECT_EQ(image::divide_at_constrictions(dumbbell(14.5)).count, 1);
}

TEST(Basins, IgnoreWhatHasNoDepth) {
  Mask mask(box_of(20, 20, 20));
  mask(10, 10, 10) = mask(11, 10, 10) = 1;
  const auto basins = image::divide_at_constrictions(mask);
  EXPECT_EQ(basins.count, 0);
}

TEST(ValvePatch, IsTheDiscBetweenTwoPools) {
  LabelVolume chambers(box_of(40, 40, 40));
  chest::for_each_voxel(chambers.grid, [&](const Vec3& p, std::size_t v) {
    if (std::hypot(p.x - 30, p.y - 30) < 12) chambers.voxels[v] = tag(p.z < 30.5 ? Region::lv_blood : Region::aorta);
  });
  const auto patch = find_valve_patch(chambers, Region::lv_blood, Region::aorta);
  ASSERT_TRUE(patch.has_value());
  EXPECT_LT(norm(patch->centre_mm - Vec3{30, 30, 30.75}), 0.1);
  EXPECT_LT(norm(patch->normal - Vec3{0, 0, 1}), 1e-9);
  EXPECT_NEAR(patch->diameter_mm, 24, 1);
  EXPECT_NEAR(patch->share, 1, 1e-9);
  EXPECT_FALSE(find_valve_patch(chambers, Region::lv_blood, Region::la_blood).has_value());
}

TEST(Sections, OfAnObliqueTubeAreTightestAcrossIt) {
  const Vec3 axis = normalized(Vec3{1, 0, 2}), centre{30, 30, 30};
  Volume<float> blood(box_of(41, 41, 41));
  chest::for_each_voxel(blood.grid, [&](const Vec3& p, std::size_t v) {
    const double along = dot(p - centre, axis);
    const double radius = 9 + 0.02 * along * along;  // narrowest at the centre
    blood.voxels[v] = norm(p - centre - along * axis) < radius;
  });
  const auto plane = image::tightest_plane(blood, centre + 4 * axis, Vec3{0, 0, 1}, 6);
  ASSERT_TRUE(plane.has_value());
  EXPECT_NEAR(dot(plane->section.centre_mm - centre, axis), 0, 2);
  EXPECT_LT(image::angle_deg(plane->normal, axis), 6);
  EXPECT_NEAR(plane->section.diameter_mm(), 18, 1);
}

TEST(DivideAtPlane, LeavesWhatBulgesPastThePlane) {
  // An atrium above z = 30 over a ventricle below, and a recess of the ventricle beside the atrium.
  LabelVolume chambers(box_of(40, 20, 40));
  chest::for_each_voxel(chambers.grid, [&](const Vec3& p, std::size_t v) {
    const bool atrium = p.x < 25 && p.z >= 24, ventricle = p.z<24, recess = p.x> 35 && p.z < 45;
    if (ventricle || recess || atrium) chambers.voxels[v] = tag(atrium ? Region::ra_blood : Region::rv_blood);
  });
  divide_at_plane(chambers, Region::rv_blood, Region::ra_blood, {0, 0, 30.5}, {0, 0, 1});
  EXPECT_EQ(chambers(5, 10, 18), tag(Region::rv_blood)) << "atrium below the plane";
  EXPECT_EQ(chambers(5, 10, 25), tag(Region::ra_blood));
  EXPECT_EQ(chambers(30, 10, 25), tag(Region::rv_blood)) << "recess above the plane";
}

TEST(Statistics, TwoMediansOfTwoGroups) {
  std::vector<float> values;
  for (int n = -10; n <= 10; ++n) {
    values.push_back(static_cast<float>(50 + n));
    values.push_back(static_cast<float>(400 + 2 * n));
  }
  const auto levels = image::two_medians(values, 0.2, 0.8);
  EXPECT_NEAR(levels.low, 50, 1);
  EXPECT_NEAR(levels.high, 400, 2);
}

TEST(Statistics, PrincipalAxesOfALine) {
  std::vector<Vec3> points;
  for (int n = -5; n <= 5; ++n) points.push_back({1.0 + n, 2.0 + 2 * n, 3.0 - 2 * n});
  const auto axes = image::principal_axes(points);
  EXPECT_NEAR(std::abs(dot(axes.axis[0], normalized({1, 2, -2}))), 1, 1e-12);
  EXPECT_NEAR(axes.deviation[0], 3 * std::sqrt(10.0), 1e-9);
  EXPECT_NEAR(axes.deviation[2], 0, 1e-6);
}

}  // namespace
}  // namespace heartgen::landmarks
