// SPDX-License-Identifier: GPL-3.0-or-later
// The images of the phantom: grids, labels, grey values, noise, repeatability.
#include "datasets/phantom/phantom.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "datasets/phantom/image.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "support/places.hpp"

namespace heartgen::phantom {
namespace {

PhantomSettings coarse() {
  PhantomSettings settings;
  settings.size = {72, 64, 56};
  settings.spacing_mm = {5, 5, 5.5};
  settings.companions = false;
  return settings;
}

TEST(Phantom, SameBitsForAnyNumberOfThreads) {
  const int before = parallel::thread_count();
  parallel::set_thread_count(1);
  const auto one = make_phantom(coarse());
  parallel::set_thread_count(3);
  const auto three = make_phantom(coarse());
  parallel::set_thread_count(before);
  EXPECT_EQ(one.ct.voxels, three.ct.voxels);
  EXPECT_EQ(one.labels.voxels, three.labels.voxels);
  EXPECT_EQ(one.fibers.x.voxels, three.fibers.x.voxels);
}

TEST(Phantom, LabelsAreTheModelAtVoxelCentres) {
  const auto phantom = make_phantom(coarse());
  EXPECT_EQ(phantom.ct.grid, phantom.labels.grid);
  const Grid& grid = phantom.labels.grid;
  for (std::int64_t n = 0; n < grid.voxel_count(); n += 97) {
    EXPECT_EQ(phantom.labels.voxels[static_cast<std::size_t>(n)],
              tag(region_at(phantom.model, testing::lps_of_voxel(grid, n))));
  }
}

TEST(Phantom, FibersFillTheMuscleAndNothingElse) {
  const auto phantom = make_phantom(coarse());
  int muscle = 0, fibrous = 0;  // the plates of the valves have no fibres
  for (std::size_t n = 0; n < phantom.labels.voxels.size(); ++n) {
    const auto region = static_cast<Region>(phantom.labels.voxels[n]);
    const bool inside =
        region == Region::lv_myocardium || region == Region::rv_myocardium || region == Region::papillary;
    const double length =
        std::hypot(phantom.fibers.x.voxels[n], phantom.fibers.y.voxels[n], phantom.fibers.z.voxels[n]);
    const bool plate = inside && length == 0;
    EXPECT_NEAR(length, inside && !plate ? 1 : 0, 1e-5);
    muscle += inside;
    fibrous += plate;
  }
  EXPECT_GT(muscle, 800);
  EXPECT_LT(fibrous, 0.1 * muscle);
}

TEST(Phantom, SmallFieldOfViewIsCentredOnTheHeart) {
  const auto model = make_heart_model();
  const auto grid = phantom_grid(model, {40, 40, 40}, {4, 4, 4});
  const auto marks = landmarks_of(model);
  for (const auto* name : {"lv_blood", "rv_blood", "la_blood", "ra_blood"}) {
    const Vec3 index = index_from_lps(grid, marks.seeds_mm.at(name));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GT(index[axis], 5) << name;
      EXPECT_LT(index[axis], 34) << name;
    }
  }
}

TEST(Phantom, DefaultFieldOfViewHoldsTheSkinAllAround) {
  const auto model = make_heart_model();
  const PhantomSettings settings;
  const auto grid = phantom_grid(model, settings.size, settings.spacing_mm);
  const double last_x = static_cast<double>(grid.size[0] - 1), last_y = static_cast<double>(grid.size[1] - 1);
  for (const double k : heartgen::testing::steps(0, 100, 9))  // below the shoulders
    for (const double t : heartgen::testing::steps(0, 1.01, 0.02))
      for (const Vec3& index :
           {Vec3{0, t * last_y, k}, Vec3{last_x, t * last_y, k}, Vec3{t * last_x, 0, k}, Vec3{t * last_x, last_y, k}})
        EXPECT_EQ(region_at(model, lps_from_index(grid, index)), Region::none);
}

/// Mean and standard deviation of the grey values of voxels whose whole neighbourhood is one tissue.
std::array<double, 3> statistics(const Phantom& phantom, Tissue tissue) {
  const Grid& grid = phantom.ct.grid;
  double sum = 0, squares = 0, count = 0;
  const auto samples = sample_volume(*phantom.model.anatomy, grid);
  for (std::int64_t k = 1; k + 1 < grid.size[2]; ++k)
    for (std::int64_t j = 1; j + 1 < grid.size[1]; ++j)
      for (std::int64_t i = 1; i + 1 < grid.size[0]; ++i) {
        bool pure = true;
        for (std::int64_t n = 0; n < 27 && pure; ++n)
          pure = samples.tissues(i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1) == static_cast<std::uint8_t>(tissue);
        if (!pure) continue;
        const double value = phantom.ct(i, j, k);
        sum += value;
        squares += value * value;
        ++count;
      }
  const double mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean), count};
}

TEST(Phantom, TissuesHaveTheirGreyValuesAndTheNoiseAskedFor) {
  auto settings = coarse();
  settings.size = {76, 66, 52};
  settings.spacing_mm = {2.2, 2.2, 2.2};
  const auto phantom = make_phantom(settings);
  const std::pair<Tissue, double> expected[] = {{Tissue::left_blood, 420}, {Tissue::right_blood, 300},
                                                {Tissue::myocardium, 110}, {Tissue::lung, -850},
                                                {Tissue::liver, 92},       {Tissue::fat, -95}};
  for (const auto& [tissue, hu] : expected) {
    const auto [mean, deviation, count] = statistics(phantom, tissue);
    ASSERT_GT(count, 200) << static_cast<int>(tissue);
    EXPECT_NEAR(mean, hu, 4) << static_cast<int>(tissue);
    EXPECT_NEAR(deviation, settings.noise_hu, 4) << static_cast<int>(tissue);
  }
}

TEST(Phantom, NoiseIsNormalAndCorrelatedInThePlaneOnly) {
  Grid grid;
  grid.size = {60, 60, 40};
  Volume<float> noise(grid);
  add_noise(noise, 10, 5);
  double variance = 0, in_plane = 0, across = 0, beyond_2_sigma = 0, mean = 0;
  for (std::int64_t k = 1; k < 40; ++k)
    for (std::int64_t j = 0; j < 60; ++j)
      for (std::int64_t i = 1; i < 60; ++i) {
        const double v = noise(i, j, k);
        mean += v;
        variance += v * v;
        in_plane += v * noise(i - 1, j, k);
        across += v * noise(i, j, k - 1);
        beyond_2_sigma += std::abs(v) > 20;
      }
  const double n = 39.0 * 60 * 59;
  EXPECT_NEAR(mean / n, 0, 0.15);
  EXPECT_NEAR(std::sqrt(variance / n), 10, 0.15);
  EXPECT_NEAR(in_plane / variance, 0.56, 0.03);  // 2 s / (1 + 2 s^2) with s = 0.35
  EXPECT_NEAR(across / variance, 0, 0.02);
  EXPECT_NEAR(beyond_2_sigma / n, 0.0455, 0.005);
}

TEST(Phantom, CompanionsShowAnotherPatientAndABifurcation) {
  auto settings = coarse();
  settings.size = {16, 16, 16};
  settings.companions = true;
  const auto phantom = make_phantom(settings);
  EXPECT_FALSE(phantom.torso_mr.grid == phantom.ct.grid);
  const auto& own = phantom.landmarks;
  const auto& other = phantom.torso_mr_landmarks;
  EXPECT_GT(norm(own.valves.at("mitral").center_mm - other.valves.at("mitral").center_mm), 2);
  for (const auto& [name, seed] : other.seeds_mm)
    EXPECT_EQ(region_name(tag(region_at(phantom.torso_model, seed))), name);
  // Fat is brighter than muscle, lung darker than both.
  const auto value = [&](const char* name) {
    return sample_linear(phantom.torso_mr, index_from_lps(phantom.torso_mr.grid, other.seeds_mm.at(name)));
  };
  EXPECT_LT(value("lung"), 120);
  EXPECT_GT(value("liver"), 300);
  // One lumen at the bottom, two at the top.
  const auto& labels = phantom.carotid_labels;
  const auto lumens = [&](std::int64_t k) {
    int starts = 0;
    bool any_before = false;
    for (std::int64_t j = 0; j < labels.grid.size[1]; ++j) {
      bool any = false;
      for (std::int64_t i = 0; i < labels.grid.size[0]; ++i) any = any || labels(i, j, k) == tag(Region::carotid);
      starts += any && !any_before;
      any_before = any;
    }
    return starts;
  };
  EXPECT_EQ(lumens(2), 1);
  EXPECT_EQ(lumens(labels.grid.size[2] - 3), 2);
  const Vec3 seed = index_from_lps(labels.grid, phantom.carotid_seed_mm);
  EXPECT_EQ(labels(std::lround(seed.x), std::lround(seed.y), std::lround(seed.z)), tag(Region::carotid));
  EXPECT_GT(sample_linear(phantom.carotid, seed), 250);
}

TEST(Phantom, RefusesSettingsOutOfRange) {
  auto settings = coarse();
  settings.size = {4, 64, 64};
  EXPECT_THROW(make_phantom(settings), UserError);
  settings = coarse();
  settings.spacing_mm.y = 0;
  EXPECT_THROW(make_phantom(settings), UserError);
  settings = coarse();
  settings.noise_hu = std::nan("");
  EXPECT_THROW(make_phantom(settings), UserError);
  settings = coarse();
  settings.variant = -3;
  EXPECT_THROW(make_phantom(settings), UserError);
}

}  // namespace
}  // namespace heartgen::phantom
