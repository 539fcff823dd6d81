// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/wall_thickness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "support/noise.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double mean_mm = 4;
constexpr anatomy::FaintContrast twelve_hu{
    .muscle_hu = 110, .blood_hu = 122, .noise_power = 480};  // 22 HU in voxels of 1 mm³

/// A plate of muscle, flat at x = 6 mm, over blood, in an image of noise.
struct Plate {
  Volume<float> hu, distance_mm;
  Mask speaks;

  template <class Thickness>
  Plate(const anatomy::FaintContrast& contrast, const Thickness& thickness_mm) {
    Grid grid;
    grid.size = {26, 60, 60};
    grid.origin_mm = {5, -30, 70};
    hu = distance_mm = Volume<float>(grid);
    speaks = Mask(grid);
    std::mt19937 random(3);
    for (std::int64_t k = 0; k < 60; ++k)
      for (std::int64_t j = 0; j < 60; ++j)
        for (std::int64_t i = 0; i < 26; ++i) {
          const double noise = testing::noise(random);
          const double from = std::max(static_cast<double>(i) - 6, 0.0);
          const double blood =
              std::clamp(from - thickness_mm(static_cast<double>(j), static_cast<double>(k)) + 0.5, 0.0, 1.0);
          hu(i, j, k) = static_cast<float>(contrast.muscle_hu + blood * contrast.difference_hu() +
                                           noise * std::sqrt(contrast.noise_power));
          distance_mm(i, j, k) = static_cast<float>(from);
          speaks(i, j, k) = from > blurred_mm;
        }
  }

  Volume<float> measure(const anatomy::FaintContrast& contrast, const anatomy::WallNeighbours& neighbours) const {
    return anatomy::local_thickness(hu, distance_mm, mean_mm, speaks, contrast, neighbours);
  }
};

/// Mean distance to the truth away from the image's border.
template <class Thickness>
double mean_error_mm(const Volume<float>& found, const Thickness& thickness_mm) {
  double sum = 0;
  for (std::int64_t k = 10; k < 50; ++k)
    for (std::int64_t j = 10; j < 50; ++j)
      sum +=
          std::abs(static_cast<double>(found(11, j, k)) - thickness_mm(static_cast<double>(j), static_cast<double>(k)));
  return sum / 1600;
}

TEST(LocalThickness, FollowsAWallThatGrowsThicker) {
  const auto wedge = [](double j, double) { return 3 + j / 30; };
  const Plate plate(twelve_hu, wedge);
  EXPECT_LT(mean_error_mm(plate.measure(twelve_hu, {.across_mm = 6}), wedge), 0.25);
  EXPECT_GT(mean_error_mm(Volume<float>(plate.hu.grid, mean_mm), wedge), 0.3);
}

TEST(LocalThickness, NeighboursAlongRidgesShowThem) {
  const auto ridges = [](double j, double) { return mean_mm + 1.2 * std::cos(2 * std::numbers::pi * j / 11); };
  const Plate plate(twelve_hu, ridges);
  const double round = mean_error_mm(plate.measure(twelve_hu, {.across_mm = 6}), ridges);
  const double along =
      mean_error_mm(plate.measure(twelve_hu, {.across_mm = 2, .along_mm = 8, .along = {0, 0, 1}}), ridges);
  EXPECT_LT(along, 0.7 * round);
}

TEST(LocalThickness, IsTheMeanOneWhereNothingSpeaks) {
  const auto wedge = [](double j, double) { return 3 + j / 30; };
  const anatomy::FaintContrast none{.muscle_hu = 110, .blood_hu = 110, .noise_power = 480};
  const Plate plate(twelve_hu, wedge);
  for (const float mm : plate.measure(none, {.across_mm = 6}).voxels)
    ASSERT_NEAR(static_cast<double>(mm), mean_mm, 1e-4);
  Plate silent(twelve_hu, wedge);
  silent.speaks = Mask(silent.hu.grid);
  for (const float mm : silent.measure(twelve_hu, {.across_mm = 6}).voxels)
    ASSERT_NEAR(static_cast<double>(mm), mean_mm, 1e-4);
}

/// The septum's upper end, the outflow tract's wall, is thin; beside the aortic root no other wall is thicker.
TEST(MeasuredCavity, TheSeptumGrowsThinBesideTheAorticRoot) {
  constexpr double lv_ends = 4, root_ends_mm = 3;
  constexpr anatomy::WallThickness mean{.left_mm = 10};
  const auto thickness_mm = [](double from_root_mm) { return from_root_mm < 12 ? 8.0 : 10.0; };
  Grid grid;
  grid.size = {28, 50, 60};
  Volume<float> hu(grid);
  anatomy::WallDistances walls{Volume<float>(grid, 40), Volume<float>(grid), Volume<float>(grid), mean.left_mm};
  std::mt19937 random(3);
  for (std::int64_t k = 0; k < 60; ++k)
    for (std::int64_t j = 0; j < 50; ++j)
      for (std::int64_t i = 0; i < 28; ++i) {
        const double noise = testing::noise(random);
        const double from = std::max(static_cast<double>(i) - lv_ends, 0.0),
                     root = static_cast<double>(j) + root_ends_mm;
        walls.from_lv(i, j, k) = static_cast<float>(from);
        walls.from_other_left(i, j, k) = static_cast<float>(root);
        const double blood = std::clamp(from - thickness_mm(root) + 0.5, 0.0, 1.0);
        hu(i, j, k) = static_cast<float>(twelve_hu.muscle_hu + blood * twelve_hu.difference_hu() +
                                         noise * std::sqrt(twelve_hu.noise_power));
      }
  const auto inside = anatomy::measured_cavity(hu, walls, Mask(grid), Mask(grid, 1), mean, twelve_hu, {0, 0, 1});
  double error_mm = 0;
  for (std::int64_t k = 10; k < 50; ++k)
    for (std::int64_t j = 1; j <= 5; ++j) {
      const double at = 8, found = at - static_cast<double>(inside(12, j, k));
      error_mm += std::abs(found - thickness_mm(static_cast<double>(j) + root_ends_mm)) / 200;
    }
  EXPECT_LT(error_mm, 0.9);  // 1.04 where grey values beside the root have no say, as the windows reach 6 mm
}

/// A wall of known thickness between two pools lies elsewhere than where they were divided.
TEST(LocalMiddle, FollowsAWallBetweenTwoPools) {
  constexpr double wall_mm = 4;
  const auto middle = [](double j, double) { return (j - 30) / 20; };
  Grid grid;
  grid.size = {36, 60, 60};
  Volume<float> hu(grid), off_mm(grid);
  std::mt19937 random(3);
  for (std::int64_t k = 0; k < 60; ++k)
    for (std::int64_t j = 0; j < 60; ++j)
      for (std::int64_t i = 0; i < 36; ++i) {
        const double noise = testing::noise(random);
        const double off = static_cast<double>(i) - 18, from = off - middle(static_cast<double>(j), 0);
        const double blood = std::clamp(std::abs(from) - wall_mm / 2 + 0.5, 0.0, 1.0);
        off_mm(i, j, k) = static_cast<float>(off);
        hu(i, j, k) = static_cast<float>(twelve_hu.muscle_hu + blood * twelve_hu.difference_hu() +
                                         noise * std::sqrt(twelve_hu.noise_power));
      }
  const auto found = anatomy::local_middle(hu, off_mm, wall_mm, Mask(grid, 1), twelve_hu, {.across_mm = 5});
  const auto error = [&](const Volume<float>& mm) {
    double sum = 0;
    for (std::int64_t k = 10; k < 50; ++k)
      for (std::int64_t j = 10; j < 50; ++j)
        sum += std::abs(static_cast<double>(mm(18, j, k)) - middle(static_cast<double>(j), 0));
    return sum / 1600;
  };
  EXPECT_LT(error(found), 0.25);
  EXPECT_GT(error(Volume<float>(grid)), 0.45);
  for (const float mm : anatomy::local_middle(hu, off_mm, wall_mm, Mask(grid), twelve_hu, {.across_mm = 5}).voxels)
    ASSERT_NEAR(static_cast<double>(mm), 0, 1e-4);
}

}  // namespace
}  // namespace heartgen::anatomy
