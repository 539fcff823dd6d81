// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/total_variation.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::at_threads;
using testing::ball;
using testing::grid_of;
using testing::slab_of;
const auto alone = parallel::self();

TEST(TotalVariation, OfAConeIsPiTimesItsRadius) {
  const double radius = 20;
  const auto cone = [&](double x, double y, double) { return std::max(0.0, 1 - testing::length(x, y) / radius); };
  for (const Vec3 spacing : {Vec3{1, 1, 3}, Vec3{0.5, 0.8, 3}}) {
    const auto image = testing::volume_of(grid_of({100, 64, 1}, spacing), cone);
    EXPECT_NEAR(pde::total_variation(slab_of(image), alone), std::numbers::pi * radius,
                0.01 * std::numbers::pi * radius);
  }
}

/// The minimiser for a disc of radius r is the disc, lower by 1 / (lambda r).
TEST(TotalVariationL2, LowersADiscByItsPerimeterOverItsArea) {
  auto slab = slab_of(ball(grid_of({128, 128, 1}), 25.5));
  pde::total_variation_l2(slab, {0.2, 400}, alone);
  EXPECT_NEAR(slab.row(64, 0)[64], 1 - 1 / (0.2 * 25.5), 0.02);
  EXPECT_NEAR(slab.row(2, 0)[2], 0.2 / 5 * 0.77, 0.02);  // the background rises: what the disc lost, spread out
}

TEST(TotalVariationL2, EnergyFallsBelowTheImagesAndTheConstants) {
  const auto image = testing::noisy(ball(grid_of({32, 32, 16}, {0.5, 0.5, 1}), 5), 0.3);
  auto slab = slab_of(image);
  const pde::TotalVariationSettings settings{1.0, 200};
  pde::total_variation_l2(slab, settings, alone);
  const auto energy = [&](const parallel::Slab<float>& u) {
    double sum = 0;
    for (std::size_t i = 0; i < image.voxels.size(); ++i) sum += std::pow(u.owned()[i] - image.voxels[i], 2);
    return pde::total_variation(u, alone) + settings.lambda * sum * image.grid.voxel_volume_mm3();
  };
  EXPECT_LT(energy(slab), 0.6 * energy(slab_of(image)));
  auto further = slab_of(image);
  pde::total_variation_l2(further, {1.0, 2000}, alone);
  EXPECT_LT(energy(slab), 1.002 * energy(further));
}

TEST(TotalVariationL1, KeepsOrDropsADiscByItsRadiusWhateverItsContrast) {
  for (const float contrast : {1.0f, 500.0f}) {
    auto image = ball(grid_of({64, 64, 1}), 8);
    for (auto& v : image.voxels) v *= contrast;
    auto kept = slab_of(image), dropped = slab_of(image);
    pde::total_variation_l1(kept, {1.4 * 2 / 8, 1500}, alone);
    pde::total_variation_l1(dropped, {0.7 * 2 / 8, 1500}, alone);
    EXPECT_GT(kept.row(32, 0)[32], 0.98f * contrast);
    EXPECT_LT(dropped.row(32, 0)[32], 0.02f * contrast);
  }
}

TEST(MarquinaOsher, RemovesNoiseAndKeepsALargeDisc) {
  const auto clean = testing::volume_of(
      grid_of({64, 64, 1}), [](double x, double y, double) { return testing::length(x, y) < 20 ? 100 : 0; });
  auto slab = slab_of(testing::noisy(clean, 10));
  pde::marquina_osher(slab, {0.005, 30, 0.2}, alone);
  double error = 0;
  for (std::size_t i = 0; i < clean.voxels.size(); ++i) error += std::pow(slab.owned()[i] - clean.voxels[i], 2);
  EXPECT_LT(std::sqrt(error / double(clean.voxels.size())), 7);
  EXPECT_NEAR(slab.row(32, 0)[32], 100, 5);
}

TEST(TotalVariation, HasTheSameBitsForAnyNumberOfThreads) {
  const auto image = testing::noisy(ball(grid_of({21, 18, 7}, {1, 0.8, 1.5}), 5), 0.3);
  for (auto* filter : {pde::total_variation_l2, pde::total_variation_l1}) {
    const auto results = at_threads([&] {
      auto slab = slab_of(image);
      filter(slab, {1.0, 25}, alone);
      return slab.values;
    });
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
  }
}

TEST(TotalVariation, RefusesBadSettings) {
  auto slab = slab_of(ball(grid_of({8, 8, 1}), 2));
  EXPECT_THROW(pde::total_variation_l2(slab, {0, 10}, alone), UserError);
  EXPECT_THROW(pde::total_variation_l1(slab, {1, -1}, alone), UserError);
}

}  // namespace
}  // namespace heartgen::pde
