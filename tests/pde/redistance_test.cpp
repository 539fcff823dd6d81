// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/redistance.hpp"

#include <gtest/gtest.h>

#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::grid_of;
const auto alone = parallel::self();

TEST(Redistance, TurnsADistortedSphereIntoItsDistance) {
  const Grid grid = grid_of({41, 41, 29}, {0.7, 0.7, 1.0});
  const auto distorted = testing::volume_of(
      grid, [](double x, double y, double z) { return (0.2 + 0.05 * (x + 15)) * (x * x + y * y + z * z - 64); });
  const auto exact =
      testing::volume_of(grid, [](double x, double y, double z) { return testing::length(x, y, z) - 8; });
  auto slab = testing::slab_of(distorted);
  pde::redistance(slab, {60}, alone);
  double worst = 0, near_zero = 0;
  for (std::size_t i = 0; i < exact.voxels.size(); ++i) {
    const double error = std::abs(slab.owned()[i] - exact.voxels[i]);
    if (exact.voxels[i] > -6) worst = std::max(worst, error);
    if (std::abs(exact.voxels[i]) < 0.7) near_zero = std::max(near_zero, error);
  }
  EXPECT_LT(near_zero, 0.12);
  EXPECT_LT(worst, 0.7);  // first order: below one voxel
}

TEST(Redistance, KeepsTheDistanceToAPlaneExactly) {
  const auto plane = testing::volume_of(grid_of({20, 6, 1}, {0.5, 0.5, 1}), [](double x, double, double) { return x; });
  auto slab = testing::slab_of(plane);
  pde::redistance(slab, {50}, alone);
  for (std::size_t i = 0; i < plane.voxels.size(); ++i) EXPECT_NEAR(slab.owned()[i], plane.voxels[i], 1e-5);
}

TEST(Redistance, WithoutAZeroLevelDistancesGrowAndNothingBreaks) {
  auto slab = testing::slab_of(Volume<float>(grid_of({6, 6, 6}), 1.0f));
  pde::redistance(slab, {4}, alone);
  for (const float v : slab.owned()) EXPECT_FLOAT_EQ(v, 3.0f);
}

}  // namespace
}  // namespace heartgen::pde
