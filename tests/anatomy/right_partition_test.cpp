// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/right_partition.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/labels.hpp"
#include "support/noise.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double wall_mm = 4, radius_mm = 9, off_mm = 1.2;
constexpr anatomy::FaintContrast ten_hu{
    .muscle_hu = 110, .blood_hu = 120, .noise_power = 480};  // 22 HU in voxels of 1 mm³

/// Atrium and ventricle side by side along x; the wall between them lies farther in the ventricle than where the two
/// were divided, and has a round orifice.
struct Scene {
  Volume<float> hu;
  LabelVolume nearest;
  Mask compartment;
  anatomy::WallDistances walls;
  ValvePlane tricuspid;
};

double to_orifice_mm(std::int64_t j, std::int64_t k) {
  return std::hypot(static_cast<double>(j) - 30, static_cast<double>(k) - 30) - radius_mm;
}

Scene make_scene() {
  Grid grid;
  grid.size = {40, 60, 60};
  const Volume<float> far(grid, 100);
  Scene scene{Volume<float>(grid),
              LabelVolume(grid),
              Mask(grid, 1),
              {far, far, far, 10},
              {{19.5, 30, 30}, {1, 0, 0}, radius_mm}};
  std::mt19937 random(3);
  for (std::int64_t k = 0; k < 60; ++k)
    for (std::int64_t j = 0; j < 60; ++j)
      for (std::int64_t i = 0; i < 40; ++i) {
        const double noise = testing::noise(random);
        const double off = static_cast<double>(i) - 19.5 - off_mm;
        const bool wall = std::abs(off) < wall_mm / 2 && to_orifice_mm(j, k) > 0;
        scene.nearest(i, j, k) = tag(i < 20 ? Region::ra_blood : Region::rv_blood);
        scene.hu(i, j, k) =
            static_cast<float>((wall ? ten_hu.muscle_hu : ten_hu.blood_hu) + noise * std::sqrt(ten_hu.noise_power));
      }
  return scene;
}

Volume<float> find(const Scene& scene, const anatomy::FaintContrast& contrast) {
  return anatomy::outside_right_partition(scene.hu, scene.walls, scene.nearest, scene.compartment, scene.tricuspid,
                                          contrast, wall_mm);
}

/// Mean distance (mm) by which `outside` differs from that of a wall `shift_mm` from the division, off its rim.
double error_mm(const Volume<float>& outside, double shift_mm) {
  double sum = 0, voxels = 0;
  for (std::int64_t k = 6; k < 54; ++k)
    for (std::int64_t j = 6; j < 54; ++j)
      for (std::int64_t i = 14; i < 28; ++i) {
        if (to_orifice_mm(j, k) < 4) continue;
        const double truth = std::abs(static_cast<double>(i) - 19.5 - shift_mm) - wall_mm / 2;
        sum += std::abs(static_cast<double>(outside(i, j, k)) - truth);
        voxels += 1;
      }
  return sum / voxels;
}

TEST(RightPartition, LiesWhereTheGreyValuesShowIt) {
  const Scene scene = make_scene();
  EXPECT_LT(error_mm(find(scene, ten_hu), off_mm), 0.4);
  const anatomy::FaintContrast none{.muscle_hu = 115, .blood_hu = 115, .noise_power = 480};
  EXPECT_LT(error_mm(find(scene, none), 0), 0.1);  // nothing speaks: where the cavities were divided
}

TEST(RightPartition, IsOpenAtTheValve) {
  const Scene scene = make_scene();
  const auto outside = find(scene, ten_hu);
  for (std::int64_t k = 0; k < 60; ++k)
    for (std::int64_t j = 0; j < 60; ++j)
      for (std::int64_t i = 15; i < 25; ++i) ASSERT_TRUE(to_orifice_mm(j, k) > -0.1 || outside(i, j, k) > 0);
}

}  // namespace
}  // namespace heartgen::anatomy
