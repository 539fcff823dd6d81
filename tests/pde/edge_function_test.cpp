// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/edge_function.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen {
namespace {

using namespace testing;
using parallel::self;
using pde::edge_function;

Volume<float> edges_of(const Volume<float>& image, const pde::EdgeSettings& settings) {
  return parallel::gather(edge_function(slab_of(image), settings, self()), self());
}

TEST(EdgeFunction, IsTheFormulaOnARamp) {
  const auto grid = grid_of({9, 8, 7}, {0.5, 1, 2});
  const auto ramp = volume_of(grid, [](double x, double y, double z) { return 3 * x - 4 * y + 12 * z; });
  const auto h = edges_of(ramp, {0, 26});  // the slope is 13
  for (std::int64_t k = 1; k < 6; ++k)
    for (std::int64_t j = 1; j < 7; ++j)
      for (std::int64_t i = 1; i < 8; ++i) ASSERT_NEAR(h(i, j, k), 0.8, 1e-5);
}

TEST(EdgeFunction, SmoothingIsAGaussianInMillimetres) {
  for (const double spacing : {0.5, 1.0}) {
    const auto grid = grid_of({64, 3, 1}, {spacing, spacing, 5});
    const auto step = volume_of(grid, [](double x, double, double) { return x < 0 ? 0 : 100; });
    const double sigma = 2.5, slope = 100 / (sigma * std::sqrt(2 * std::numbers::pi));
    const auto h = edges_of(step, {sigma, slope});
    // The step lies between two voxels, half a spacing from each.
    const double expected = std::exp(-spacing * spacing / (8 * sigma * sigma));
    EXPECT_NEAR(h(31, 1, 0), 1 / (1 + expected * expected), 0.01);
    EXPECT_GT(h(2, 1, 0), 0.999);
  }
}

TEST(EdgeFunction, HasTheSameBitsOnAnyNumberOfThreads) {
  const auto image = noisy(ball(grid_of({17, 15, 9}, {1, 1, 2}), 5), 0.3);
  const auto results = at_threads([&] { return edges_of(image, {1.2, 0.2}).voxels; });
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(EdgeFunction, UsualEdgeFollowsTheGreyScale) {
  const auto image = ball(grid_of({30, 30, 1}), 8);
  auto brighter = image;
  for (auto& v : brighter.voxels) v = 50 * v - 20;
  EXPECT_NEAR(pde::default_edge_per_mm(brighter, 1) / pde::default_edge_per_mm(image, 1), 50, 1e-3);
  EXPECT_GT(pde::default_edge_per_mm(Volume<float>(grid_of({4, 4, 1}), 7), 1), 0);
}

TEST(EdgeFunction, MistakesAreUserErrors) {
  const auto image = slab_of(ball(grid_of({8, 8, 1}), 2));
  EXPECT_THROW(edge_function(image, {-1, 1}, self()), UserError);
  EXPECT_THROW(edge_function(image, {1, 0}, self()), UserError);
  EXPECT_THROW(pde::default_edge_per_mm({}, 1), UserError);
}

}  // namespace
}  // namespace heartgen
