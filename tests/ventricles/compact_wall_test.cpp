// SPDX-License-Identifier: GPL-3.0-or-later
// Thickness of the compact wall and what lies beyond the valves, against closed forms.
#include "generator/ventricles/compact_wall.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/phantom/shapes.hpp"
#include "generator/ventricles/openings.hpp"

namespace heartgen {
namespace {

using ventricles::Part;

constexpr Vec3 middle_mm{30, 30, 30};

Grid cube(std::int64_t n, double spacing_mm) {
  Grid grid;
  grid.size = {n, n, n};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  return grid;
}

template <class Value>
LevelSet filled(const Grid& grid, Value&& value_at) {
  LevelSet result(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        result(i, j, k) = static_cast<float>(
            value_at(lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})));
  return result;
}

TEST(DistanceAlongGradient, DependsOnlyOnWhereTheZeroSetLies) {
  const double radius_mm = 20;
  const auto grid = cube(61, 1);
  const auto half = filled(grid, [&](const Vec3& p) { return 0.5 * (norm(p - middle_mm) - radius_mm); });
  const auto squared = filled(grid, [&](const Vec3& p) {
    const double r = norm(p - middle_mm);
    return r * r - radius_mm * radius_mm;
  });
  for (const double r : {14.3, 17.0, 19.9, 20.4, 23.0})
    for (const Vec3& direction : {normalized({1, 2, -0.5}), Vec3{0, 0, 1}, normalized({-3, 1, 1})})
      for (const auto* surface : {&half, &squared})
        EXPECT_NEAR(ventricles::distance_along_gradient(*surface, middle_mm + r * direction), r - radius_mm, 0.05) << r;
}

/// A wall between a sphere of 20 mm outside and a cavity that leaves it `thickness_mm` thick in direction z, a tenth of
/// `taper_mm` less per tenth of z, with ridges of 2 mm along the meridians where `ridged`.
struct RidgedWall {
  double thickness_mm = 5, taper_mm = 0;
  bool ridged = false;
  double floor_at(const Vec3& direction) const { return thickness_mm - taper_mm * direction.z; }
  double cavity_at(const Vec3& p) const {
    const Vec3 d = p - middle_mm;
    const double wave = ridged ? 0.5 + 0.5 * std::cos(8 * std::atan2(d.y, d.x)) : 0;
    return norm(d) - (20 - floor_at(norm(d) > 1e-9 ? normalized(d) : Vec3{0, 0, 1}) - 2 * wave * wave);
  }
};

ventricles::CompactWall compact_wall_of(const RidgedWall& wall) {
  const auto grid = cube(61, 1);
  const auto cavity = filled(grid, [&](const Vec3& p) { return wall.cavity_at(p); });
  const auto outer = filled(grid, [&](const Vec3& p) { return norm(p - middle_mm) - 20; });
  return ventricles::CompactWall(ventricles::endocardial_thickness(cavity, outer, Mask(grid, 1)), 0.1);
}

std::vector<Vec3> directions_around() {
  std::vector<Vec3> directions;
  for (int n = 0; n < 40; ++n) {
    const double z = -0.6 + 1.2 * n / 39, angle = 2.4 * n, across = std::sqrt(1 - z * z);
    directions.push_back({across * std::cos(angle), across * std::sin(angle), z});
  }
  return directions;
}

TEST(CompactWall, FollowsTheFloorBetweenRidges) {
  const RidgedWall wall{5, 0, true};
  const auto compact = compact_wall_of(wall);
  for (const Vec3& direction : directions_around()) {
    const auto thickness = compact.at(middle_mm + 17 * direction);
    ASSERT_TRUE(thickness);
    EXPECT_NEAR(thickness->mm, 5, 0.25);  // the wall is 5.75 mm thick on average, 7 mm on the ridges
  }
}

TEST(CompactWall, FollowsAWallThatThins) {
  const RidgedWall wall{6, 2, false};
  const auto compact = compact_wall_of(wall);
  double worst_gradient = 0;
  for (const Vec3& direction : directions_around()) {
    const auto thickness = compact.at(middle_mm + (20 - wall.floor_at(direction)) * direction);
    ASSERT_TRUE(thickness);
    EXPECT_NEAR(thickness->mm, wall.floor_at(direction), 0.2);
    const Vec3 along = normalized(Vec3{0, 0, 1} - direction.z * direction);
    const double expected = -2 * dot(Vec3{0, 0, 1}, along) / (20 - wall.floor_at(direction));
    worst_gradient = std::max(worst_gradient, std::abs(dot(thickness->gradient, along) - expected));
  }
  EXPECT_LT(worst_gradient, 0.06);
}

TEST(CompactWall, FollowsTheMiddleOfUnevenSamples) {
  constexpr double thickness_mm = 4, uneven_mm = 0.4;
  std::vector<ventricles::ThicknessSample> samples;
  for (std::uint64_t n = 0; n < 8000; ++n) {
    const double z = -1 + 2 * (static_cast<double>(n) + 0.5) / 8000, angle = 2.39996 * static_cast<double>(n);
    const double across = std::sqrt(1 - z * z);
    const Vec3 direction{across * std::cos(angle), across * std::sin(angle), z};
    samples.push_back({middle_mm + 30 * direction, thickness_mm + uneven_mm * double{phantom::random_normal(3, n)}});
  }
  const ventricles::CompactWall compact(samples, 0.1);
  double mean_mm = 0;
  for (const Vec3& direction : directions_around()) mean_mm += compact.at(middle_mm + 30 * direction)->mm / 40;
  EXPECT_NEAR(mean_mm, thickness_mm, 0.2);  // the lower half alone lies 0.3 below
}

TEST(CompactWall, HasNoThicknessWithoutSamples) {
  const ventricles::CompactWall compact({}, 0.1);
  EXPECT_FALSE(compact.at(middle_mm));
}

/// A cube's lower half is right ventricular blood, the upper half the pulmonary artery's, twice as wide as the orifice.
TEST(BloodBeyond, GoesOnThroughTheOrificeAndNoWider) {
  const auto grid = cube(41, 1);
  LabelVolume labels(grid, tag(Region::pulmonary_artery));
  for (std::int64_t v = 0; v < grid.voxel_count() / 2; ++v)
    labels.voxels[static_cast<std::size_t>(v)] = tag(Region::rv_blood);
  const Vec3 valve_mm{20, 20, 20};
  const auto beyond = ventricles::blood_beyond(labels, grid, {{"pulmonary", {valve_mm, {0, 0, 1}, 10}}});
  EXPECT_EQ(beyond(20, 20, 24), tag(Part::rv_cavity));
  EXPECT_EQ(beyond(29, 20, 24), tag(Part::rv_cavity));
  EXPECT_EQ(beyond(32, 20, 24), tag(Part::outside));
  EXPECT_EQ(beyond(20, 20, 30), tag(Part::outside));
  EXPECT_EQ(beyond(20, 20, 16), tag(Part::outside));
  const auto inflow = ventricles::blood_beyond(labels, grid, {{"tricuspid", {valve_mm, {0, 0, 1}, 10}}});
  EXPECT_EQ(inflow(20, 20, 24), tag(Part::outside));
}

}  // namespace
}  // namespace heartgen
