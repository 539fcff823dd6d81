// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/faint_blood.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "generator/anatomy/wall_thickness.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double muscle_hu = 110, fat_hu = -90, left_hu = 400;
const Vec3 lv{-26, 0, 0}, pool{12, 0, 0};
constexpr double lv_radius_mm = 15, lv_wall_mm = 9, pool_radius_mm = 18, free_wall_mm = 3.5;

/// A ball of left blood in a ball of muscle, beside a ball of blood in a wall of 3.5 mm, all in fat. The wall between
/// the two balls of blood is thinner than the left one's elsewhere: nothing known tells the pool's radius there.
struct Scene {
  Volume<float> hu;
  Mask lv, other_left, truth, compartment, nowhere;
};

Scene make_scene(double blood_hu, double noise_hu, double wall_mm = free_wall_mm) {
  Grid grid;
  grid.size = {100, 64, 64};
  grid.origin_mm = {-60, -32, -32};
  Scene scene{Volume<float>(grid), Mask(grid), Mask(grid), Mask(grid), Mask(grid), Mask(grid)};
  std::uint32_t state = 2024;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Vec3 p = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const double from_lv = norm(p - lv), from_pool = norm(p - pool);
        const bool muscle = from_lv < lv_radius_mm + lv_wall_mm || from_pool < pool_radius_mm + wall_mm;
        scene.lv.voxels[v] = from_lv < lv_radius_mm;
        scene.truth.voxels[v] = from_pool < pool_radius_mm && from_lv > lv_radius_mm + lv_wall_mm;
        scene.compartment.voxels[v] = from_pool < pool_radius_mm - 3;
        state = state * 1664525U + 1013904223U;
        const double noise = (static_cast<double>(state >> 8U) / 16777216.0 - 0.5) * std::sqrt(12.0) * noise_hu;
        const double grey = scene.lv.voxels[v]      ? left_hu
                            : scene.truth.voxels[v] ? blood_hu
                            : muscle                ? muscle_hu
                                                    : fat_hu;
        scene.hu.voxels[v] = static_cast<float>(grey + noise);
      }
  return scene;
}

struct Found {
  anatomy::FaintContrast contrast;
  Volume<float> blood;
  double dice = 0, lv_wall_mm = 0;
};

Found find(const Scene& scene) {
  const auto walls = anatomy::measure_walls(scene.hu, scene.lv, scene.other_left, muscle_hu);
  const auto usual = anatomy::prior_thickness(walls);
  auto space = anatomy::prior_cavity(walls, scene.nowhere, usual);
  Found found;
  found.lv_wall_mm = walls.lv_wall_mm;
  found.contrast = anatomy::measure_faint_contrast(scene.hu, walls, space, scene.compartment);
  const auto mean =
      anatomy::measure_thickness(scene.hu, walls, scene.nowhere, scene.compartment, usual, found.contrast);
  space = anatomy::measured_cavity(scene.hu, walls, scene.nowhere, scene.compartment, mean, found.contrast, {0, 0, 1});
  found.blood =
      anatomy::faint_blood(scene.hu, walls, space, scene.compartment, found.contrast, anatomy::measured_walls);
  double both = 0, sum = 0;
  for (std::size_t v = 0; v < scene.truth.voxels.size(); ++v) {
    const bool blood = found.blood.voxels[v] > 0, truth = scene.truth.voxels[v] != 0;
    both += blood && truth;
    sum += blood + truth;
  }
  found.dice = 2 * both / sum;
  return found;
}

TEST(FaintBlood, MeasuresWallGreyValuesAndNoise) {
  const Found found = find(make_scene(130, 20));
  EXPECT_NEAR(found.lv_wall_mm, lv_wall_mm, 1);
  EXPECT_NEAR(found.contrast.muscle_hu, muscle_hu, 2);
  EXPECT_NEAR(found.contrast.blood_hu, 130, 2);
  EXPECT_NEAR(found.contrast.noise_power, 400, 100);  // white noise on voxels of 1 mm³: its variance
}

struct FaintCase {
  double contrast_hu, min_dice;
};
/// A slab of blood, 20 mm thick and endless, between walls of uneven and unusual thickness: fat on both sides.
struct Slab {
  Volume<float> hu;
  Mask none, compartment;
};

Slab make_slab(double wall_mm, double blood_hu, double noise_hu) {
  Grid grid;
  grid.size = {60, 60, 60};
  Slab slab{Volume<float>(grid), Mask(grid), Mask(grid)};
  std::uint32_t state = 7;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < 60; ++k)
    for (std::int64_t n = 0; n < 3600; ++n, ++v) {
      const double depth = std::abs(static_cast<double>(k) - 29.5);
      state = state * 1664525U + 1013904223U;
      const double noise = (static_cast<double>(state >> 8U) / 16777216.0 - 0.5) * std::sqrt(12.0) * noise_hu;
      const double grey = depth < 10 ? blood_hu : depth < 10 + wall_mm ? muscle_hu : fat_hu;
      slab.hu.voxels[v] = static_cast<float>(grey + noise);
      slab.compartment.voxels[v] = depth < 8;
    }
  return slab;
}

TEST(FaintBlood, TheMeanFreeWallIsMeasuredWhereNoSingleVoxelShowsIt) {
  for (const double wall_mm : {3.0, 4.0, 5.0}) {
    const Slab slab = make_slab(wall_mm, muscle_hu - 8, 28);
    const auto walls = anatomy::measure_walls(slab.hu, slab.none, slab.none, muscle_hu);
    const auto thickness = anatomy::measure_thickness(slab.hu, walls, slab.none, slab.compartment,
                                                      anatomy::prior_thickness(walls), {muscle_hu, muscle_hu - 8, 784});
    EXPECT_NEAR(thickness.free_mm, wall_mm, 0.5) << wall_mm;
    EXPECT_EQ(thickness.thin_mm, anatomy::WallThickness{}.thin_mm);
  }
}

TEST(FaintBlood, WallsHaveTheirUsualThicknessWhereNothingSpeaks) {
  const Slab slab = make_slab(5, muscle_hu, 0);
  const auto walls = anatomy::measure_walls(slab.hu, slab.none, slab.none, muscle_hu);
  const auto usual = anatomy::prior_thickness(walls);
  const auto thickness =
      anatomy::measure_thickness(slab.hu, walls, slab.none, slab.compartment, usual, {muscle_hu, muscle_hu, 784});
  EXPECT_NEAR(thickness.free_mm, usual.free_mm, 0.1);
  EXPECT_NEAR(thickness.left_mm, usual.left_mm, 0.1);
}

/// A rod of blood as thin as an appendage, with no contrast at all: the price of a contour must not shrink it.
TEST(FaintBlood, SmoothnessDoesNotEatWhatIsRoundAndThin) {
  Grid grid;
  grid.size = {40, 40, 40};
  Volume<float> hu(grid);
  Mask none(grid), compartment(grid);
  double truth = 0, found = 0;
  std::vector<std::uint8_t> inside;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < 40; ++k)
    for (std::int64_t j = 0; j < 40; ++j)
      for (std::int64_t i = 0; i < 40; ++i, ++v) {
        const double radius = std::hypot(static_cast<double>(i) - 19.5, static_cast<double>(j) - 19.5);
        hu.voxels[v] = static_cast<float>(radius < 7 + free_wall_mm ? muscle_hu : fat_hu);
        compartment.voxels[v] = radius < 5;
        inside.push_back(radius < 7);
      }
  const auto walls = anatomy::measure_walls(hu, none, none, muscle_hu);
  const auto blood =
      anatomy::faint_blood(hu, walls, anatomy::prior_cavity(walls, none), compartment, {muscle_hu, muscle_hu, 784});
  for (v = 0; v < inside.size(); ++v) {
    truth += inside[v];
    found += blood.voxels[v] > 0;
  }
  EXPECT_NEAR(found / truth, 1, 0.06);
}

class FaintContrasts : public ::testing::TestWithParam<FaintCase> {};

TEST_P(FaintContrasts, ShowThePool) {
  EXPECT_GT(find(make_scene(muscle_hu + GetParam().contrast_hu, 20)).dice, GetParam().min_dice);
}

// Brighter, darker, and not at all: then the pool is what usual walls leave.
INSTANTIATE_TEST_SUITE_P(Values, FaintContrasts,
                         ::testing::Values(FaintCase{-40, 0.97}, FaintCase{-15, 0.93}, FaintCase{0, 0.92},
                                           FaintCase{15, 0.93}, FaintCase{40, 0.97}));

/// A muscle across the pool, which usual anatomy knows nothing of: half of what was blood is muscle.
TEST(FaintBlood, TheImageOverrulesUsualAnatomyWhereItIsClear) {
  Scene scene = make_scene(muscle_hu + 40, 20);
  const Grid& grid = scene.hu.grid;
  double half = 0;
  for (std::size_t v = 0; v < scene.truth.voxels.size(); ++v) {
    const auto row = static_cast<std::int64_t>(v) / grid.size[0];
    const bool upper = row / grid.size[1] > 32;
    if (!scene.truth.voxels[v] || !upper) continue;
    scene.hu.voxels[v] -= 40;
    scene.truth.voxels[v] = 0;
    half += 1;
  }
  for (std::size_t v = 0; v < scene.compartment.voxels.size(); ++v)
    if (static_cast<std::int64_t>(v) / (grid.size[0] * grid.size[1]) > 30) scene.compartment.voxels[v] = 0;
  ASSERT_GT(half, 5000);
  EXPECT_GT(find(scene).dice, 0.93);
}

/// Mean distance by which the half of the pool that is far from the left ventricle ends inside the truth, mm.
double inset_mm(const Volume<float>& blood, const Scene& scene) {
  double found = 0, truth = 0;
  for (std::size_t v = 0; v < blood.voxels.size(); ++v) {
    const auto i = static_cast<std::int64_t>(v) % blood.grid.size[0];
    if (blood.grid.origin_mm.x + static_cast<double>(i) < pool.x) continue;
    found += blood.voxels[v] > 0;
    truth += scene.truth.voxels[v];
  }
  return pool_radius_mm * (1 - std::cbrt(found / truth));
}

TEST(FaintBlood, ThinWallsKeepTheirThickness) {
  for (const double blood_hu : {100.0, 125.0}) {
    const Scene scene = make_scene(blood_hu, 20, anatomy::WallThickness{}.thin_mm);
    const auto walls = anatomy::measure_walls(scene.hu, scene.lv, scene.other_left, muscle_hu);
    const Mask thin(scene.hu.grid, 1);
    const auto space = anatomy::prior_cavity(walls, thin);
    const auto contrast = anatomy::measure_faint_contrast(scene.hu, walls, space, scene.compartment);
    const auto blood = anatomy::faint_blood(scene.hu, walls, space, scene.compartment, contrast);
    EXPECT_NEAR(inset_mm(anatomy::settle_thin_walls(blood, space, thin), scene), 0, 0.15) << blood_hu << " HU";
    const auto untouched = anatomy::settle_thin_walls(blood, space, scene.nowhere);
    EXPECT_EQ(untouched.voxels, blood.voxels);
  }
}

}  // namespace
}  // namespace heartgen::anatomy
