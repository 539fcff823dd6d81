// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/muscle_bundles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "generator/image/gaussian.hpp"
#include "support/noise.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double information = 0.08;  // nats per mm³: muscle and blood 12 HU apart, noise of 30 HU in voxels of 1 mm³

double rod_distance_mm(const anatomy::MuscleBundle& rod, const Vec3& p) {
  const Vec3 axis = rod.to_mm - rod.from_mm;
  const double t = std::clamp(dot(p - rod.from_mm, axis) / dot(axis, axis), 0.0, 1.0);
  return norm(p - rod.from_mm - t * axis) - rod.radius_mm;
}

Vec3 place(std::int64_t i, std::int64_t j, std::int64_t k) {
  return {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
}

/// Evidence of blood with rods of what speaks for muscle `times` as much as muscle does. The noise of a grey value that
/// tells two classes apart by `information` has twice that variance.
Volume<float> evidence_of(const std::vector<anatomy::MuscleBundle>& rods, unsigned seed, double times = 1) {
  Grid grid;
  grid.size = {48, 48, 48};
  Volume<float> evidence(grid);
  std::mt19937 random(seed);
  for (std::int64_t k = 0; k < 48; ++k)
    for (std::int64_t j = 0; j < 48; ++j)
      for (std::int64_t i = 0; i < 48; ++i) {
        const double noise = testing::noise(random);
        const bool muscle = std::any_of(rods.begin(), rods.end(),
                                        [&](const auto& rod) { return rod_distance_mm(rod, place(i, j, k)) < 0; });
        evidence(i, j, k) =
            static_cast<float>((muscle ? times : -1) * information + noise * std::sqrt(2 * information));
      }
  return evidence;
}

double dice(const std::vector<anatomy::MuscleBundle>& a, const std::vector<anatomy::MuscleBundle>& b) {
  const auto inside = [](const std::vector<anatomy::MuscleBundle>& rods, const Vec3& p) {
    return std::any_of(rods.begin(), rods.end(), [&](const auto& rod) { return rod_distance_mm(rod, p) < 0; });
  };
  double both = 0, sum = 0;
  for (std::int64_t k = 0; k < 48; ++k)
    for (std::int64_t j = 0; j < 48; ++j)
      for (std::int64_t i = 0; i < 48; ++i) {
        const bool in_a = inside(a, place(i, j, k)), in_b = inside(b, place(i, j, k));
        both += in_a && in_b;
        sum += in_a + in_b;
      }
  return 2 * both / sum;
}

class OneRod : public ::testing::TestWithParam<anatomy::MuscleBundle> {};

TEST_P(OneRod, IsFoundWhereNoSingleVoxelShowsIt) {
  const std::vector<anatomy::MuscleBundle> truth = {GetParam()};
  const auto found = anatomy::find_muscle_bundles(evidence_of(truth, 5), information);
  ASSERT_FALSE(found.empty());
  EXPECT_GT(dice(found, truth), 0.7);
}

INSTANTIATE_TEST_SUITE_P(OfManyPoses, OneRod,
                         ::testing::Values(anatomy::MuscleBundle{{12, 20, 10}, {17, 31, 36}, 4, 0},
                                           anatomy::MuscleBundle{{8, 22, 24}, {38, 27, 21}, 3.5, 0},
                                           anatomy::MuscleBundle{{14, 34, 30}, {32, 13, 25}, 4.5, 0}));

/// The wall is a plane below the rod, which stands on it and points upwards.
TEST(MuscleBundles, StandOnTheWallAndPointToTheOrifice) {
  const anatomy::MuscleBundle rod{{12, 20, 10}, {17, 31, 36}, 4, 0};
  const Volume<float> evidence = evidence_of({rod}, 5);
  const auto found = [&](double wall_mm, const std::optional<Vec3>& orifice_mm) {
    anatomy::MuscleAnchors anchors{Volume<float>(evidence.grid), orifice_mm};
    for (std::size_t v = 0; v < evidence.voxels.size(); ++v)
      anchors.from_wall_mm.voxels[v] = static_cast<float>(std::max(static_cast<double>(v / (48 * 48)) - wall_mm, 0.0));
    return anatomy::find_muscle_bundles(evidence, information, anchors);
  };
  const double under_foot_mm = 6, far_below_mm = -20;
  ASSERT_FALSE(found(under_foot_mm, Vec3{20, 38, 70}).empty());
  EXPECT_GT(dice(found(under_foot_mm, Vec3{20, 38, 70}), {rod}), 0.7);
  EXPECT_GT(dice(found(under_foot_mm, std::nullopt), {rod}), 0.7);
  EXPECT_TRUE(found(under_foot_mm, Vec3{9, 13, -20}).empty());
  EXPECT_TRUE(found(far_below_mm, Vec3{20, 38, 70}).empty());
}

/// A thin rod, seen blurred: a share s of muscle's grey value has (2 s - 1) of its evidence. By the likelihood of the
/// blurred rod every voxel speaks for it by s² of muscle's evidence.
TEST(MuscleBundles, AThinBlurredOneIsWeighedAsItIsSeen) {
  const anatomy::MuscleBundle truth{{12, 24, 24}, {36, 24, 24}, 2.2, 0};
  constexpr double blur_mm = 0.8;
  Grid grid;
  grid.size = {48, 48, 48};
  Volume<float> share(grid), evidence(grid);
  for (std::int64_t k = 0; k < 48; ++k)
    for (std::int64_t j = 0; j < 48; ++j)
      for (std::int64_t i = 0; i < 48; ++i) share(i, j, k) = rod_distance_mm(truth, place(i, j, k)) < 0 ? 1 : 0;
  share = image::gaussian(share, blur_mm);
  double expected = 0, sharp = 0;
  for (std::size_t v = 0; v < share.voxels.size(); ++v) {
    const auto s = static_cast<double>(share.voxels[v]);
    evidence.voxels[v] = static_cast<float>((2 * s - 1) * information);
    expected += s * s * information;
    sharp += std::max(0.0, 2 * s - 1) * information;
  }
  const auto found = anatomy::find_muscle_bundles(evidence, information);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].nats, expected, 0.05 * expected);
  EXPECT_GT(found[0].nats, 1.15 * sharp);
  EXPECT_NEAR(found[0].radius_mm, truth.radius_mm, 0.3);
  EXPECT_GT(dice(found, {truth}), 0.7);
}

TEST(MuscleBundles, NoiseAloneHasNone) {
  for (unsigned seed = 1; seed <= 4; ++seed)
    EXPECT_TRUE(anatomy::find_muscle_bundles(evidence_of({}, seed), information).empty()) << seed;
}

/// The image is as wide as the ventricle, so that many rods of noise stand on its wall; the orifice is above it.
TEST(MuscleBundles, NoiseAloneHasNoneThatIsHeldEither) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Volume<float> noise = evidence_of({}, seed);
    anatomy::MuscleAnchors anchors{Volume<float>(noise.grid), Vec3{24, 24, 60}};
    for (std::int64_t k = 0; k < 48; ++k)
      for (std::int64_t j = 0; j < 48; ++j)
        for (std::int64_t i = 0; i < 48; ++i)
          anchors.from_wall_mm(i, j, k) = static_cast<float>(std::min({i, 47 - i, j, 47 - j, k}));
    EXPECT_TRUE(anatomy::find_muscle_bundles(noise, information, anchors).empty()) << seed;
  }
}

/// Grains of several voxels make rods of far more nats than noise that differs from voxel to voxel.
TEST(MuscleBundles, CoarseNoiseAloneHasNoneEither) {
  constexpr double grain_voxels = 0.6, times = 0.45;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    Volume<float> noise = evidence_of({}, seed);
    for (float& nats : noise.voxels) nats += static_cast<float>(information);
    noise = image::gaussian(noise, grain_voxels);
    double square = 0;
    for (const float nats : noise.voxels) square += static_cast<double>(nats) * static_cast<double>(nats);
    const double deviation = std::sqrt(square / static_cast<double>(noise.voxels.size()));
    for (float& nats : noise.voxels)
      nats =
          static_cast<float>(times * std::sqrt(2 * information) / deviation) * nats - static_cast<float>(information);
    EXPECT_TRUE(anatomy::find_muscle_bundles(noise, information).empty()) << seed;
  }
}

TEST(MuscleBundles, TwoThatCrossAreBothFoundAndDoNotOverlap) {
  const std::vector<anatomy::MuscleBundle> truth = {{{10, 24, 12}, {14, 24, 38}, 4, 0},
                                                    {{10, 24, 30}, {38, 20, 33}, 3.5, 0}};
  const Volume<float> evidence = evidence_of(truth, 9);
  const auto found = anatomy::find_muscle_bundles(evidence, information);
  ASSERT_GE(found.size(), 2U);
  EXPECT_GT(dice(found, truth), 0.7);
  double claimed = 0, there = 0;
  for (const auto& bundle : found) claimed += bundle.nats;
  for (std::size_t v = 0; v < evidence.voxels.size(); ++v) there += std::max(0.0F, evidence.voxels[v]);
  EXPECT_LT(claimed, there);
  EXPECT_GE(found[0].nats, found[1].nats);
}

TEST(MuscleBundles, WhatIsFarMoreThanMuscleIsNone) {
  const std::vector<anatomy::MuscleBundle> lead = {{{12, 20, 10}, {17, 31, 36}, 4, 0}};
  for (const auto& bundle : anatomy::find_muscle_bundles(evidence_of(lead, 5, 8), information))
    EXPECT_LT(dice({bundle}, lead), 0.3);
}

TEST(MuscleBundles, AreTakenOutOfBloodToTheirSurface) {
  Grid grid;
  grid.size = {30, 30, 30};
  Volume<float> blood(grid, 1);
  Mask where(grid, 1);
  for (std::int64_t k = 0; k < 30; ++k)
    for (std::int64_t j = 0; j < 30; ++j) where(20, j, k) = 0;
  const anatomy::MuscleBundle rod{{8, 15, 15}, {24, 15, 15}, 4, 0};
  anatomy::carve_bundles({rod}, where, blood);
  for (std::int64_t k = 0; k < 30; ++k)
    for (std::int64_t j = 0; j < 30; ++j)
      for (std::int64_t i = 0; i < 30; ++i) {
        const double distance = std::clamp(rod_distance_mm(rod, place(i, j, k)), -1.0, 1.0);
        ASSERT_NEAR(static_cast<double>(blood(i, j, k)), i == 20 ? 1 : distance, 1e-5);
      }
}

/// Rods of all directions, also such as leave the image, and a ball.
TEST(MuscleBundles, ObliqueRodsAreCutOutWhole) {
  Grid grid;
  grid.size = {30, 30, 30};
  const anatomy::MuscleBundle rods[] = {{{5, 6, 7}, {24, 21, 19}, 2.5, 0},     {{25, 4, 15}, {3, 26, 15.5}, 1.5, 0},
                                        {{15, 15, -6}, {15, 15.2, 35}, 3, 0},  {{-4, 2, 2}, {9, 2, 11}, 2, 0},
                                        {{14, 14, 14}, {14, 14, 14.01}, 4, 0}, {{2, 28, 29}, {27, 28, 29}, 2.2, 0}};
  for (const auto& rod : rods) {
    Volume<float> blood(grid, 1);
    anatomy::carve_bundles({rod}, Mask(blood.grid, 1), blood);
    for (std::int64_t k = 0; k < 30; ++k)
      for (std::int64_t j = 0; j < 30; ++j)
        for (std::int64_t i = 0; i < 30; ++i)
          ASSERT_NEAR(static_cast<double>(blood(i, j, k)), std::clamp(rod_distance_mm(rod, place(i, j, k)), -1.0, 1.0),
                      1e-5);
  }
}

}  // namespace
}  // namespace heartgen::anatomy
