// SPDX-License-Identifier: GPL-3.0-or-later
// The pulmonary valve of a faint right heart: where the ventricle's muscular wall ends and the artery's thin one
// begins.
#include "generator/landmarks/pulmonary_valve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "generator/chest/working_image.hpp"
#include "generator/image/gaussian.hpp"
#include "model/labels.hpp"
#include "support/noise.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double muscle_hu = 110, blood_hu = 118, vessel_hu = 60, fat_hu = -95;
constexpr double radius_mm = 12, muscle_mm = 3.6, vessel_mm = 1.8;

const Vec3 axis = normalized({0.35, 0.2, 1});

double radial_mm(const Vec3& p) { return norm(p - dot(p, axis) * axis); }

/// A straight tube in fat, the artery downstream of the valve; where asked for, something bright lies around the artery
/// from 8 to 16 mm.
double hu_at(const Vec3& p, double valve_mm, bool collar) {
  constexpr double collar_hu = 200;
  const double outside_mm = radial_mm(p) - radius_mm;
  if (collar && outside_mm >= 0 && outside_mm < muscle_mm && std::abs(dot(p, axis) - 12) < 4) return collar_hu;
  if (outside_mm < 0) return blood_hu;
  if (dot(p, axis) < valve_mm) return outside_mm < muscle_mm ? muscle_hu : fat_hu;
  return outside_mm < vessel_mm ? vessel_hu : fat_hu;
}

struct Scene {
  chest::WorkingImage image;
  LabelVolume chambers;
  FaintRightHeart right;
};

/// Of the middle of 27 points a voxel, and noise; the pools are parted in the middle.
Scene make_scene(double valve_mm, double noise_hu, bool collar = false) {
  Grid grid;
  grid.size = {32, 32, 48};
  grid.spacing_mm = {chest::working_spacing_mm, chest::working_spacing_mm, chest::working_spacing_mm};
  grid.origin_mm = {-23.25, -23.25, -35.25};
  Scene scene{{Volume<float>(grid), {}}, LabelVolume(grid), {}};
  std::mt19937 bits(7);
  chest::for_each_voxel(grid, [&](const Vec3& p, std::size_t v) {
    double sum = 0;
    const double noise = testing::noise(bits);
    for (int part = 0; part < 27; ++part) {
      const int a = part % 3 - 1, b = part / 3 % 3 - 1, c = part / 9 - 1;
      sum += hu_at(p + Vec3{0.5 * a, 0.5 * b, 0.5 * c}, valve_mm, collar);
    }
    scene.image.hu.voxels[v] = static_cast<float>(sum / 27 + noise_hu * noise);
    if (radial_mm(p) < radius_mm)
      scene.chambers.voxels[v] = tag(dot(p, axis) < 0 ? Region::rv_blood : Region::pulmonary_artery);
  });
  scene.image.smooth = image::gaussian(scene.image.hu, 1);
  const Mask none(grid);
  scene.right = {
      {muscle_hu, blood_hu, 1}, anatomy::measure_walls(scene.image.hu, none, none, muscle_hu), Mask(grid, 1)};
  return scene;
}

class PulmonaryValveAt : public ::testing::TestWithParam<double> {};

TEST_P(PulmonaryValveAt, OfAFaintHeartIsWhereTheWallChangesBetweenSections) {
  const Scene scene = make_scene(GetParam(), 12);
  ValvePatch parted;
  parted.normal = axis;
  const auto valve = find_pulmonary_valve(scene.chambers, scene.image, scene.right, parted, std::nullopt);
  EXPECT_NEAR(dot(valve.centre_mm, axis), GetParam(), 0.6);  // sections are 2 mm apart
  EXPECT_GT(dot(valve.normal, axis), std::cos(0.08));
}

INSTANTIATE_TEST_SUITE_P(AtManyHeights, PulmonaryValveAt, ::testing::Values(-9.0, -8.5, -8.0, -7.5, -4.3, 3.1));

TEST(PulmonaryValve, WhatLiesBesideTheArteryFarFromTheUsualPlaceIsNoValve) {
  constexpr double valve_mm = -8;
  const Scene scene = make_scene(valve_mm, 0, true);
  ValvePatch parted;
  parted.centre_mm = 12.0 * axis;
  parted.normal = axis;
  const auto found_mm = [&](const std::optional<Vec3>& typical_mm) {
    return dot(find_pulmonary_valve(scene.chambers, scene.image, scene.right, parted, typical_mm).centre_mm, axis);
  };
  EXPECT_GT(found_mm(std::nullopt), 10);  // the bright thing's edge is the sharper one
  EXPECT_NEAR(found_mm((valve_mm - 10) * axis), valve_mm, 1.5);
}

/// The whole tube has the artery's wall.
TEST(PulmonaryValve, WhereNoWallTellsTheNearerToTheUsualPlaceCounts) {
  const Scene scene = make_scene(-1000, 0);
  ValvePatch parted;
  parted.normal = axis;
  const auto found_mm = [&](const std::optional<Vec3>& typical_mm) {
    return dot(find_pulmonary_valve(scene.chambers, scene.image, scene.right, parted, typical_mm).centre_mm, axis);
  };
  EXPECT_EQ(found_mm(std::nullopt), 0);
  EXPECT_EQ(found_mm(5.0 * axis), 0);
  EXPECT_LT(found_mm(-30.0 * axis), -15);
}

}  // namespace
}  // namespace heartgen::landmarks
