// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/chan_vese.hpp"

#include <gtest/gtest.h>

#include <random>

#include "generator/pde/chan_vese_flow.hpp"
#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::at_threads;
using testing::grid_of;
using testing::length;
using testing::noisy;
using testing::slab_of;
using testing::volume_of;
const auto alone = parallel::self();

/// Two discs (value `high`) on a background (value `low`).
Volume<float> two_discs(const Grid& grid, double low, double high) {
  return volume_of(grid, [=](double x, double y, double) {
    return length(x + 14, y) < 9 || length(x - 12, y + 3) < 7 ? high : low;
  });
}

int different(const Mask& found, const Volume<float>& clean, float threshold) {
  int count = 0;
  for (std::size_t i = 0; i < clean.voxels.size(); ++i)
    count += (clean.voxels[i] > threshold) != (found.voxels[i] != 0);
  return count;
}

TEST(ChanVese, FindsNoisyDiscsWhereThresholdingFails) {
  const Grid grid = grid_of({64, 48, 1});
  const auto clean = two_discs(grid, -100, 200);
  const auto image = noisy(clean, 130);
  for (const pde::Norm norm : {pde::Norm::l1, pde::Norm::l2}) {
    pde::ChanVeseSettings settings;
    settings.norm = norm;
    settings.max_iterations = 400;
    settings.mu = 0;
    const auto plain = pde::chan_vese(image, Mask(grid, 1), settings, alone);
    EXPECT_EQ(plain.iterations, 0);
    EXPECT_GT(different(plain.above, clean, 50), 200);
    settings.mu = 1.0;
    const auto smooth = pde::chan_vese(image, Mask(grid, 1), settings, alone);
    EXPECT_TRUE(smooth.converged);
    EXPECT_LT(different(smooth.above, clean, 50), 25);
    EXPECT_NEAR(smooth.c_below, -100, 12);
    EXPECT_NEAR(smooth.c_above, 200, 20);
  }
}

TEST(ChanVese, DoesNotDependOnTheGreyScale) {
  const Grid grid = grid_of({64, 48, 1});
  const auto image = noisy(two_discs(grid, -128, 128), 60);
  auto scaled = image;
  for (auto& v : scaled.voxels) v *= 0.25f;
  pde::ChanVeseSettings settings;
  settings.mu = 0.8;
  const auto a = pde::chan_vese(image, Mask(grid, 1), settings, alone);
  const auto b = pde::chan_vese(scaled, Mask(grid, 1), settings, alone);
  EXPECT_LE(different(a.above, volume_of(grid, [](double, double, double) { return 0; }), 1), 64 * 48);
  int moved = 0;
  for (std::size_t i = 0; i < a.above.voxels.size(); ++i) moved += a.above.voxels[i] != b.above.voxels[i];
  EXPECT_EQ(moved, 0);
  EXPECT_NEAR(a.c_above, 4 * b.c_above, 1e-4);
}

TEST(ChanVese, EnergyIsNotAboveThresholding) {
  const Grid grid = grid_of({40, 36, 12}, {0.6, 0.6, 1.1});
  const auto image =
      noisy(volume_of(grid, [](double x, double y, double z) { return length(x, y, z) < 5 ? 60 : 0; }), 25);
  const auto slab = slab_of(image);
  const auto domain = slab_of(Mask(grid, 1));
  for (const double mu : {0.05, 0.2, 1.0}) {
    pde::ChanVeseSettings settings;
    settings.mu = mu;
    settings.max_iterations = 300;
    auto threshold = settings;
    threshold.mu = 0;
    const auto plain = pde::chan_vese(slab, domain, threshold, alone);
    const auto smooth = pde::chan_vese(slab, domain, settings, alone);
    EXPECT_LE(smooth.energy,
              pde::chan_vese_energy(slab, domain, plain.above, plain.c_below, plain.c_above, settings, alone));
    EXPECT_DOUBLE_EQ(smooth.energy, pde::chan_vese_energy(slab, domain, smooth.above, smooth.c_below, smooth.c_above,
                                                          settings, alone));
  }
}

/// A ball of radius r costs mu 4 π r² as a contour and lambda 4/3 π r³ when it is given up.
TEST(ChanVese, DropsBallsBelowTheCriticalRadius) {
  const Grid grid = grid_of({40, 40, 40});
  const auto image = volume_of(grid, [](double x, double y, double z) {
    return length(x + 9, y, z) < 7 || length(x - 10, y, z) < 3.2 ? 100 : 0;
  });
  pde::ChanVeseSettings settings;
  settings.max_iterations = 500;
  settings.mu = 1.5;  // critical radius 4.5
  const auto found = pde::chan_vese(image, Mask(grid, 1), settings, alone);
  EXPECT_EQ(found.above(11, 20, 20), 1);
  EXPECT_EQ(found.above(30, 20, 20), 0);
}

TEST(ChanVese, StaysInsideItsDomain) {
  const Grid grid = grid_of({48, 40, 6});
  const auto domain =
      volume_of<std::uint8_t>(grid, [](double x, double y, double) { return length(x, y) < 17 ? 1 : 0; });
  // A bright surrounding must not matter.
  const auto image = volume_of(grid, [](double x, double y, double) {
    return length(x, y) >= 17 ? 3000 : x > 2 ? 80 : 10;
  });
  pde::ChanVeseSettings settings;
  settings.mu = 0.5;
  const auto found = pde::chan_vese(noisy(image, 10), domain, settings, alone);
  EXPECT_NEAR(found.c_below, 10, 2);
  EXPECT_NEAR(found.c_above, 80, 2);
  for (std::int64_t k = 0; k < 6; ++k)
    for (std::int64_t j = 0; j < 40; ++j)
      for (std::int64_t i = 0; i < 48; ++i)
        EXPECT_EQ(found.above(i, j, k), domain(i, j, k) && static_cast<double>(i) - 23.5 > 2) << i << " " << j;
}

TEST(ChanVese, MediansResistOutliersThatMeansFollow) {
  const Grid grid = grid_of({30, 30, 4});
  auto image = volume_of(grid, [](double x, double, double) { return x > 0 ? 10 : 0; });
  for (std::size_t i = 0; i < image.voxels.size(); i += 97) image.voxels[i] = 150;
  pde::ChanVeseSettings settings;
  settings.mu = 0;
  EXPECT_EQ(pde::chan_vese(image, Mask(grid, 1), settings, alone).c_above, 10);
  settings.norm = pde::Norm::l2;
  EXPECT_GT(pde::chan_vese(image, Mask(grid, 1), settings, alone).c_above, 100);
}

TEST(ChanVese, OneGreyValueHasNoContour) {
  const Grid grid = grid_of({6, 5, 4});
  const auto found = pde::chan_vese(Volume<float>(grid, 40), Mask(grid, 1), {}, alone);
  EXPECT_EQ(found.c_below, found.c_above);
  for (const auto v : found.above.voxels) EXPECT_EQ(v, 0);
}

/// Balls and waves of random places, sizes and noise.
Volume<float> random_image(const Grid& grid, std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
  };
  const double x0 = uniform(-6, 6), y0 = uniform(-5, 5), r = uniform(2, 8), wave = uniform(0.7, 1.5);
  auto image = volume_of(grid, [&](double x, double y, double z) {
    return length(x - x0, y - y0, z) < r || length(x + 8, y - 3, z) < 3 || std::sin(wave * x) * std::cos(y) > 0.9 ? 1
                                                                                                                  : 0;
  });
  const double deviation = uniform(0.1, 1.1);
  for (auto& v : image.voxels) v += static_cast<float>(deviation * (uniform(-1, 1) + uniform(-1, 1)));
  return image;
}

/// At the grey values where the thesis's flow ends, and at those of the convex form.
TEST(ChanVese, EnergyIsNeverAboveThatOfTheReferenceFlow) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 3; ++trial)
    for (const Index3 size : {Index3{36, 30, 1}, Index3{14, 13, 11}})
      for (const pde::Norm norm : {pde::Norm::l1, pde::Norm::l2})
        for (const double mu : {0.1, 0.4, 1.0, 2.5}) {
          const Grid grid = grid_of(size, {0.8, 0.8, trial % 2 ? 0.8 : 1.4});
          const auto image = slab_of(random_image(grid, random));
          const auto domain = slab_of(Mask(grid, 1));
          const pde::ChanVeseSettings settings{.norm = norm, .mu = mu, .max_iterations = 2000};
          pde::ChanVeseFlowSettings reference{.norm = norm, .mu = mu};
          const auto flow = pde::chan_vese_flow(image, domain, reference, alone);
          if (!(flow.c_below < flow.c_above)) continue;
          const auto there = pde::chan_vese_at(image, domain, flow.c_below, flow.c_above, settings, alone);
          EXPECT_LE(there.energy, flow.energy * (1 + 1e-9)) << mu << " " << size[2];
          const auto ours = pde::chan_vese(image, domain, settings, alone);
          reference.fixed_values = true;
          const auto flow_here =
              pde::chan_vese_flow(image, domain, flow.phi, ours.c_below, ours.c_above, reference, alone);
          const auto here = pde::chan_vese_at(image, domain, ours.c_below, ours.c_above, settings, alone);
          EXPECT_LE(here.energy, flow_here.energy * (1 + 1e-9)) << mu << " " << size[2];
        }
}

TEST(ChanVese, KeepsTheGreyValuesItIsGiven) {
  const Grid grid = grid_of({20, 20, 5});
  const auto image = slab_of(noisy(two_discs(grid, 0, 100), 20));
  const auto found = pde::chan_vese_at(image, slab_of(Mask(grid, 1)), 10, 70, {.mu = 0.3}, alone);
  EXPECT_EQ(found.c_below, 10);
  EXPECT_EQ(found.c_above, 70);
  EXPECT_THROW(pde::chan_vese_at(image, slab_of(Mask(grid, 1)), 70, 10, {}, alone), UserError);
}

TEST(ChanVese, RefusesBadInput) {
  const Grid grid = grid_of({6, 5, 4});
  const Volume<float> image(grid, 1);
  EXPECT_THROW(pde::chan_vese(image, Mask(grid, 0), {}, alone), UserError);
  EXPECT_THROW(pde::chan_vese(image, Mask(grid_of({6, 5, 5}), 1), {}, alone), UserError);
  pde::ChanVeseSettings settings;
  settings.lambda = 0;
  EXPECT_THROW(pde::chan_vese(image, Mask(grid, 1), settings, alone), UserError);
}

TEST(ChanVese, HasTheSameBitsForAnyNumberOfThreads) {
  const Grid grid = grid_of({31, 22, 9}, {0.8, 0.8, 1.3});
  const auto image = noisy(two_discs(grid, 0, 100), 60);
  const auto domain = volume_of<std::uint8_t>(grid, [](double x, double y, double z) { return x + y + z < 8 ? 1 : 0; });
  pde::ChanVeseSettings settings;
  settings.mu = 0.7;
  settings.norm = pde::Norm::l2;
  const auto results = at_threads([&] { return pde::chan_vese(image, domain, settings, alone); });
  for (const auto& result : results) {
    EXPECT_EQ(result.above.voxels, results[0].above.voxels);
    EXPECT_EQ(result.energy, results[0].energy);
    EXPECT_EQ(result.c_above, results[0].c_above);
  }
}

}  // namespace
}  // namespace heartgen::pde
