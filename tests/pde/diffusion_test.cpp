// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/diffusion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>

#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::at_threads;
using testing::grid_of;
using testing::noisy;
using testing::volume_of;
const auto alone = parallel::self();

/// cos(m π (i + 1/2) / n) is an eigenvector of the discrete Neumann Laplacian.
double mode(double m, double i, double n) { return std::cos(m * std::numbers::pi * (i + 0.5) / n); }
double eigenvalue(double m, double n, double h) { return (2 - 2 * std::cos(m * std::numbers::pi / n)) / (h * h); }

TEST(Heat, DecaysCosineModesAsTheExplicitSchemeDoes) {
  const Grid grid = grid_of({12, 10, 8}, {0.5, 0.8, 1.2});
  Volume<float> image(grid);
  for (std::int64_t k = 0; k < 8; ++k)
    for (std::int64_t j = 0; j < 10; ++j)
      for (std::int64_t i = 0; i < 12; ++i)
        image(i, j, k) =
            static_cast<float>(100 * mode(2, double(i), 12) * mode(1, double(j), 10) * mode(3, double(k), 8));
  const auto smooth = pde::heat(image, {7, 0.15}, alone);
  const double rate = eigenvalue(2, 12, 0.5) + eigenvalue(1, 10, 0.8) + eigenvalue(3, 8, 1.2);
  const double factor = std::pow(1 - 0.15 * 0.25 * rate, 7);
  for (std::size_t i = 0; i < image.voxels.size(); ++i) EXPECT_NEAR(smooth.voxels[i], factor * image.voxels[i], 1e-3);
}

TEST(Heat, WorksOnOneSliceAndKeepsTheMean) {
  const auto image = noisy(volume_of(grid_of({33, 21, 1}), [](double x, double, double) { return x; }), 10);
  const auto smooth = pde::heat(image, {20, 1.0 / 6}, alone);
  const auto mean = [](const Volume<float>& v) {
    return std::accumulate(v.voxels.begin(), v.voxels.end(), 0.0) / double(v.voxels.size());
  };
  EXPECT_NEAR(mean(smooth), mean(image), 1e-4);
}

TEST(Heat, RefusesUnstableSteps) {
  const Volume<float> image(grid_of({4, 4, 4}));
  EXPECT_THROW(pde::heat(image, {1, 0.2}, alone), UserError);
  EXPECT_THROW(pde::heat(image, {1, 0}, alone), UserError);
  EXPECT_THROW(pde::heat(image, {-1, 0.1}, alone), UserError);
}

/// Slices enough for several steps in a pass, in one thread, two or three, and blocks smaller than a slice.
TEST(Diffusion, ManyStepsHaveTheBitsOfSingleOnes) {
  for (const Index3 size : {Index3{3000, 17, 34}, Index3{19, 14, 75}, Index3{33, 21, 1}}) {
    const auto image = noisy(volume_of(grid_of(size, {0.5, 0.8, 1.2}), [](double x, double, double) { return x; }), 30);
    const DenoiseSettings once{.iterations = 1}, often{.iterations = 7};
    auto heated = image, denoised = image;
    for (int n = 0; n < 7; ++n) {
      heated = pde::heat(heated, {1, 0.15}, alone);
      denoised = pde::perona_malik(denoised, once, alone);
    }
    for (const auto& voxels : at_threads([&] { return pde::heat(image, {7, 0.15}, alone).voxels; }))
      EXPECT_EQ(voxels, heated.voxels);
    for (const auto& voxels : at_threads([&] { return pde::perona_malik(image, often, alone).voxels; }))
      EXPECT_EQ(voxels, denoised.voxels);
  }
}

TEST(PeronaMalik, HalvesTheFluxAtTheEdgeContrast) {
  Volume<float> pair(grid_of({2, 1, 1}));
  pair.voxels = {0, 60};
  DenoiseSettings settings;
  settings.iterations = 1;
  settings.time_step = 0.1;
  settings.edge_hu = 60;
  const auto result = pde::perona_malik(pair, settings, alone);
  EXPECT_NEAR(result.voxels[0], 0.1 * 60 / 2, 1e-5);
  EXPECT_NEAR(result.voxels[1], 60 - 0.1 * 60 / 2, 1e-5);
}

/// Voxel by voxel in double. A few voxels differ by so much that squares and products of them leave the range of a
/// float.
TEST(PeronaMalik, StepsAsTheFormulaReads) {
  const Grid grid = grid_of({37, 7, 5}, {0.7, 0.9, 1.3});
  auto image = noisy(testing::ball(grid, 3), 80);
  image(20, 3, 2) = 1e15f;
  image(5, 3, 2) = -3e30f;
  const DenoiseSettings settings{.iterations = 1, .time_step = 0.15, .edge_hu = 40};
  const auto result = pde::perona_malik(image, settings, alone);
  const auto at = [&](Index3 p, std::size_t axis, int step) {
    p[axis] = std::clamp<std::int64_t>(p[axis] + step, 0, grid.size[axis] - 1);
    return double{image(p[0], p[1], p[2])};
  };
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const double u = image(i, j, k);
        double expected = u;
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const int step : {-1, 1}) {
            const double d = at({i, j, k}, axis, step) - u, weight = 0.7 / grid.spacing_mm[static_cast<int>(axis)];
            const double conductivity = std::max(1 / (1 + d * d / 1600), 1e-8);  // as row_kernels.hpp says
            expected += 0.15 * weight * weight * conductivity * d;
          }
        ASSERT_NEAR(result(i, j, k), expected, 1e-4 + 1e-6 * std::abs(expected)) << i << " " << j << " " << k;
      }
}

TEST(PeronaMalik, RemovesNoiseAndKeepsAStep) {
  const auto step =
      volume_of(grid_of({32, 16, 8}, {0.5, 0.5, 1.25}), [](double x, double, double) { return x < 0 ? -800 : 40; });
  const auto image = noisy(step, 20);
  DenoiseSettings settings;
  settings.iterations = 10;
  settings.time_step = 1.0 / 6;
  const auto result = pde::perona_malik(image, settings, alone);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < image.voxels.size(); ++i) {
    before += std::pow(image.voxels[i] - step.voxels[i], 2);
    after += std::pow(result.voxels[i] - step.voxels[i], 2);
  }
  EXPECT_LT(after, 0.25 * before);
  EXPECT_LT(result(15, 8, 4), -700);
  EXPECT_GT(result(16, 8, 4), -60);
}

TEST(PeronaMalik, HasTheSameBitsForAnyNumberOfThreads) {
  const auto image = noisy(testing::ball(grid_of({19, 13, 7}), 4), 0.5);
  const auto results = at_threads([&] { return pde::perona_malik(image, {}, alone).voxels; });
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace heartgen::pde
