#include "generator/segment/muscle_bundles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace heart::segment {
namespace {

constexpr double information = 0.08;  // nats per mm³: muscle and blood 12 HU apart, noise of 30 HU in voxels of 1 mm³

double rod_distance_mm(const MuscleBundle& rod, const Vec3& p) {
  const Vec3 axis = rod.to_mm - rod.from_mm;
  const double t = std::clamp(dot(p - rod.from_mm, axis) / dot(axis, axis), 0.0, 1.0);
  return norm(p - rod.from_mm - t * axis) - rod.radius_mm;
}

Vec3 place(std::int64_t i, std::int64_t j, std::int64_t k) {
  return {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
}

/// Evidence of blood with rods of what speaks for muscle `times` as much as muscle does. The noise of a grey value that
/// tells two classes apart by `information` has twice that variance.
Volume<float> evidence_of(const std::vector<MuscleBundle>& rods, unsigned seed, double times = 1) {
  Grid grid;
  grid.size = {48, 48, 48};
  Volume<float> evidence(grid);
  std::mt19937 random(seed);
  for (std::int64_t k = 0; k < 48; ++k)
    for (std::int64_t j = 0; j < 48; ++j)
      for (std::int64_t i = 0; i < 48; ++i) {
        double noise = -6;  // twelve uniform numbers: the same on every platform
        for (int n = 0; n < 12; ++n) noise += static_cast<double>(random()) / 4294967296.0;
        const bool muscle = std::any_of(rods.begin(), rods.end(),
                                        [&](const auto& rod) { return rod_distance_mm(rod, place(i, j, k)) < 0; });
        evidence(i, j, k) =
            static_cast<float>((muscle ? times : -1) * information + noise * std::sqrt(2 * information));
      }
  return evidence;
}

double dice(const std::vector<MuscleBundle>& a, const std::vector<MuscleBundle>& b) {
  const auto inside = [](const std::vector<MuscleBundle>& rods, const Vec3& p) {
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

class OneRod : public testing::TestWithParam<MuscleBundle> {};

TEST_P(OneRod, IsFoundWhereNoSingleVoxelShowsIt) {
  const std::vector<MuscleBundle> truth = {GetParam()};
  const auto found = find_muscle_bundles(evidence_of(truth, 5), information);
  ASSERT_FALSE(found.empty());
  EXPECT_GT(dice(found, truth), 0.7);
}

INSTANTIATE_TEST_SUITE_P(OfManyPoses, OneRod,
                         testing::Values(MuscleBundle{{12, 20, 10}, {17, 31, 36}, 4, 0},
                                         MuscleBundle{{8, 22, 24}, {38, 27, 21}, 3.5, 0},
                                         MuscleBundle{{14, 34, 30}, {32, 13, 25}, 4.5, 0}));

TEST(MuscleBundles, NoiseAloneHasNone) {
  for (unsigned seed = 1; seed <= 4; ++seed)
    EXPECT_TRUE(find_muscle_bundles(evidence_of({}, seed), information).empty()) << seed;
}

TEST(MuscleBundles, TwoThatCrossAreBothFoundAndDoNotOverlap) {
  const std::vector<MuscleBundle> truth = {{{10, 24, 12}, {14, 24, 38}, 4, 0}, {{10, 24, 30}, {38, 20, 33}, 3.5, 0}};
  const Volume<float> evidence = evidence_of(truth, 9);
  const auto found = find_muscle_bundles(evidence, information);
  ASSERT_GE(found.size(), 2U);
  EXPECT_GT(dice(found, truth), 0.7);
  double claimed = 0, there = 0;
  for (const auto& bundle : found) claimed += bundle.nats;
  for (std::size_t v = 0; v < evidence.voxels.size(); ++v) there += std::max(0.0F, evidence.voxels[v]);
  EXPECT_LT(claimed, there);
  EXPECT_GE(found[0].nats, found[1].nats);
}

TEST(MuscleBundles, WhatIsFarMoreThanMuscleIsNone) {
  const std::vector<MuscleBundle> lead = {{{12, 20, 10}, {17, 31, 36}, 4, 0}};
  for (const auto& bundle : find_muscle_bundles(evidence_of(lead, 5, 8), information))
    EXPECT_LT(dice({bundle}, lead), 0.3);
}

TEST(MuscleBundles, AreTakenOutOfBloodToTheirSurface) {
  Grid grid;
  grid.size = {30, 30, 30};
  Volume<float> blood(grid, 1);
  Mask where(grid, 1);
  for (std::int64_t k = 0; k < 30; ++k)
    for (std::int64_t j = 0; j < 30; ++j) where(20, j, k) = 0;
  const MuscleBundle rod{{8, 15, 15}, {24, 15, 15}, 4, 0};
  carve_bundles({rod}, where, blood);
  for (std::int64_t k = 0; k < 30; ++k)
    for (std::int64_t j = 0; j < 30; ++j)
      for (std::int64_t i = 0; i < 30; ++i) {
        const double distance = std::clamp(rod_distance_mm(rod, place(i, j, k)), -1.0, 1.0);
        ASSERT_NEAR(static_cast<double>(blood(i, j, k)), i == 20 ? 1 : distance, 1e-5);
      }
}

}  // namespace
}  // namespace heart::segment
