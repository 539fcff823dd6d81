// SPDX-License-Identifier: GPL-3.0-or-later
// The orifice of a valve between pools whose grey value hardly differs from muscle, and where it usually is.
#include "generator/landmarks/orifice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "datasets/phantom/anatomy.hpp"
#include "generator/chest/working_image.hpp"
#include "generator/image/sections.hpp"
#include "generator/image/statistics.hpp"
#include "generator/landmarks/usual_valves.hpp"
#include "support/noise.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double muscle_hu = 110, fat_hu = -90, bag_mm = 28;

/// A round bag of blood, as wide as a heart at the groove, in fat; a plate of muscle 4 mm thick divides it but for a
/// round hole.
struct Bag {
  Vec3 hole_mm{4, -3, 2};
  Vec3 normal = normalized({0.8, 0.5, 0.3});
  double radius_mm = 15;
  double difference_hu = -8;  ///< blood less muscle
  double noise_hu = 10;       ///< white, per voxel
  bool has_plate = true;
};

double hu_at(const Bag& bag, const Vec3& p) {
  constexpr double half_plate_mm = 2;
  if (norm(p) > bag_mm) return fat_hu;
  const Vec3 q = p - bag.hole_mm;
  const double along = dot(q, bag.normal);
  const bool in_plate = std::abs(along) < half_plate_mm && norm(q - along * bag.normal) > bag.radius_mm;
  return muscle_hu + (bag.has_plate && in_plate ? 0 : bag.difference_hu);
}

struct Scan {
  Volume<float> hu;
  FaintRightHeart right;
};

Scan scan(const Bag& bag, unsigned seed) {
  Grid grid;
  grid.size = {48, 48, 48};
  grid.spacing_mm = {1.5, 1.5, 1.5};
  grid.origin_mm = {-35.25, -35.25, -35.25};
  Scan result{Volume<float>(grid), {}};
  auto& walls = result.right.walls;
  walls = {Volume<float>(grid), Volume<float>(grid, 100.0F), Volume<float>(grid, 100.0F), 10};
  result.right.near = Mask(grid, 1);
  std::mt19937 bits(seed);
  chest::for_each_voxel(grid, [&](const Vec3& p, std::size_t v) {
    const double noise = testing::noise(bits);
    result.hu.voxels[v] = static_cast<float>(hu_at(bag, p) + bag.noise_hu * noise);
    walls.from_outside.voxels[v] = static_cast<float>(std::max(bag_mm - norm(p), 0.0));
  });
  const double power = bag.noise_hu * bag.noise_hu * grid.voxel_volume_mm3();
  result.right.contrast = {muscle_hu, muscle_hu + bag.difference_hu, power};
  return result;
}

/// Off by 5 mm along, 6 mm across and 14 degrees.
ValvePatch first_guess(const Bag& bag) {
  const image::PlaneFrame frame = image::frame_across(bag.normal);
  ValvePatch start;
  start.normal = normalized(bag.normal + 0.25 * frame.u);
  start.centre_mm = bag.hole_mm + 5 * bag.normal + 6 * frame.v;
  start.diameter_mm = 40;
  return start;
}

class Orifice : public ::testing::TestWithParam<double> {};

TEST_P(Orifice, IsFoundInNoiseAboveTheContrast) {
  Bag bag;
  bag.difference_hu = GetParam();
  const Scan image = scan(bag, 1);
  const auto found = find_orifice(show_tissue(image.hu, image.right), first_guess(bag));
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(std::abs(dot(found->centre_mm - bag.hole_mm, bag.normal)), 1.5);  // inside the plate
  EXPECT_LT(norm(found->centre_mm - bag.hole_mm), 2);
  EXPECT_LT(image::angle_deg(found->normal, bag.normal), 3);
  EXPECT_NEAR(found->diameter_mm, 2 * bag.radius_mm, 3);
}
INSTANTIATE_TEST_SUITE_P(Contrasts, Orifice, ::testing::Values(-30.0, -8.0, 5.0));

TEST(Orifice, IsNotInventedWhereThereIsNone) {
  for (const unsigned seed : {1U, 2U}) {
    Bag bag;
    bag.has_plate = false;
    bag.noise_hu = 20;
    const Scan image = scan(bag, seed);
    EXPECT_FALSE(find_orifice(show_tissue(image.hu, image.right), first_guess(bag)).has_value()) << seed;
  }
}

TEST(Orifice, IsNotFoundWithoutContrast) {
  Bag bag;
  bag.difference_hu = 0;
  const Scan image = scan(bag, 1);
  EXPECT_FALSE(find_orifice(show_tissue(image.hu, image.right), first_guess(bag)).has_value());
}

ValvePatch patch_of(const ValvePlane& plane) {
  ValvePatch patch;
  patch.centre_mm = plane.center_mm;
  patch.normal = plane.normal;
  patch.diameter_mm = 2 * plane.radius_mm;
  return patch;
}

TEST(UsualTricuspid, IsNearTheTrueOneInEveryPose) {
  for (int variant = 0; variant < 20; ++variant) {
    const auto model = phantom::make_heart_model(variant);
    const auto marks = phantom::landmarks_of(model);
    LongAxis axis;
    axis.direction = -phantom::long_axis(model);
    const auto usual = usual_tricuspid(patch_of(marks.valves.at("mitral")), patch_of(marks.valves.at("aortic")), axis);
    const ValvePlane& truth = marks.valves.at("tricuspid");
    EXPECT_LT(norm(usual.centre_mm - truth.center_mm), 14) << variant;
    EXPECT_LT(image::angle_deg(usual.normal, truth.normal), 20) << variant;
  }
}

}  // namespace
}  // namespace heartgen::landmarks
