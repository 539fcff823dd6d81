// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/continuous_min_cut.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::at_threads;
using testing::grid_of;
using testing::length;
using testing::volume_of;
const auto alone = parallel::self();

constexpr double inner_mm = 5, outer_mm = 16;

Mask shell(const Grid& grid) {
  return volume_of<std::uint8_t>(grid, [](double x, double y, double z) {
    const double r = length(x, y, z);
    return r < inner_mm ? cut_inner : r < outer_mm ? cut_free : cut_outer;
  });
}

/// h r² has its least value at `valley_mm`.
Volume<float> valley_weight(const Grid& grid, double valley_mm) {
  return volume_of(grid, [=](double x, double y, double z) {
    const double r = std::max(length(x, y, z), 3.0), e = (r - valley_mm) / 3;
    return 100 / (r * r) * (1 - 0.8 * std::exp(-e * e));
  });
}

TEST(MinimalCut, OfASphericalShellLiesAtTheLeastWeight) {
  for (const Vec3 spacing : {Vec3{1, 1, 1}, Vec3{0.9, 0.9, 1.4}}) {
    const auto size = [](double h) { return static_cast<std::int64_t>(36 / h); };
    const Grid grid = grid_of({size(spacing.x), size(spacing.y), size(spacing.z)}, spacing);
    for (const double valley : {8.0, 12.0}) {
      const auto cut = pde::continuous_min_cut(valley_weight(grid, valley), shell(grid), {2000, 1e-3, 20}, alone);
      EXPECT_LE(cut.duality_gap, 1e-3);
      double volume = 0;
      for (const float u : cut.u.voxels) volume += u > 0.5f ? grid.voxel_volume_mm3() : 0;
      EXPECT_NEAR(std::cbrt(volume * 3 / (4 * std::numbers::pi)), valley, 0.6);
      // The least area times weight is 4 π 100 * 0.2; forward differences see up to a fifth more area on a ball.
      EXPECT_GT(cut.energy, 0.98 * 4 * std::numbers::pi * 20);
      EXPECT_LT(cut.energy, 1.22 * 4 * std::numbers::pi * 20);
    }
  }
}

TEST(MinimalCut, BetweenTwoPlanesCostsAreaTimesLeastWeight) {
  const Grid grid = grid_of({20, 7, 5}, {0.5, 1, 2});
  Mask state(grid, cut_free);
  Volume<float> weight(grid);
  for (std::int64_t k = 0; k < 5; ++k)
    for (std::int64_t j = 0; j < 7; ++j)
      for (std::int64_t i = 0; i < 20; ++i) {
        if (i < 2) state(i, j, k) = cut_inner;
        if (i >= 18) state(i, j, k) = cut_outer;
        weight(i, j, k) = i == 11 ? 0.25f : 1.0f;
      }
  const auto cut = pde::continuous_min_cut(weight, state, {3000, 1e-4, 20}, alone);
  EXPECT_LE(cut.duality_gap, 1e-4);
  EXPECT_NEAR(cut.energy, 0.25 * 7 * 1 * 5 * 2, 0.003);
  for (std::int64_t i = 0; i < 20; ++i) EXPECT_NEAR(cut.u(i, 3, 2), i <= 11 ? 1 : 0, 0.02) << i;
}

TEST(MinimalCut, KeepsTheFixedSets) {
  const Grid grid = grid_of({36, 36, 36});
  const auto state = shell(grid);
  const auto cut = pde::continuous_min_cut(valley_weight(grid, 9), state, {40, 1e-3, 20}, alone);
  for (std::size_t i = 0; i < state.voxels.size(); ++i) {
    const float low = state.voxels[i] == cut_inner ? 1.0f : 0.0f, high = state.voxels[i] == cut_outer ? 0.0f : 1.0f;
    EXPECT_GE(cut.u.voxels[i], low);
    EXPECT_LE(cut.u.voxels[i], high);
  }
}

TEST(MinimalCut, GapBoundsTheTrueError) {
  const Grid grid = grid_of({36, 36, 36});
  const auto weight = valley_weight(grid, 10);
  const auto best = pde::continuous_min_cut(weight, shell(grid), {6000, 2e-5, 100}, alone);
  for (const int iterations : {20, 60, 180}) {
    const auto cut = pde::continuous_min_cut(weight, shell(grid), {iterations, 0, 20}, alone);
    EXPECT_EQ(cut.iterations, iterations);
    EXPECT_GE(cut.energy * (1 + 1e-6), best.energy * (1 - best.duality_gap));
    EXPECT_LE(cut.energy * (1 - cut.duality_gap), best.energy * (1 + 1e-6));
  }
}

TEST(MinimalCut, RefusesBadInput) {
  const Grid grid = grid_of({12, 12, 12});
  const Volume<float> weight(grid, 1);
  EXPECT_THROW(pde::continuous_min_cut(weight, Mask(grid, cut_free), {}, alone), UserError);
  EXPECT_THROW(pde::continuous_min_cut(weight, Mask(grid, cut_inner), {}, alone), UserError);
  auto state = Mask(grid, cut_free);
  state.voxels.front() = cut_inner;
  state.voxels.back() = cut_outer;
  EXPECT_NO_THROW(pde::continuous_min_cut(weight, state, {20, 1e-3, 20}, alone));
  auto bad = weight;
  bad.voxels[100] = 0;
  EXPECT_THROW(pde::continuous_min_cut(bad, state, {}, alone), UserError);
}

TEST(MinimalCut, HasTheSameBitsForAnyNumberOfThreads) {
  const Grid grid = grid_of({36, 30, 28}, {1, 1.2, 1.3});
  const auto results = at_threads([&] {
    return pde::continuous_min_cut(valley_weight(grid, 9), shell(grid), {60, 1e-4, 20}, alone);
  });
  for (const auto& result : results) {
    EXPECT_EQ(result.u.voxels, results[0].u.voxels);
    EXPECT_EQ(result.duality_gap, results[0].duality_gap);
    EXPECT_EQ(result.energy, results[0].energy);
  }
}

}  // namespace
}  // namespace heartgen::pde
