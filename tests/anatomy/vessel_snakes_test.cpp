// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/vessel_snakes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generator/image/components.hpp"
#include "generator/image/morphology.hpp"
#include "model/error.hpp"

namespace heartgen {
namespace {

using anatomy::segment_vessel_by_snakes;

/// A slanted artery of 3 mm radius that forks into two of 2.2 mm, negative inside.
double artery(const Vec3& p) {
  const double trunk = std::hypot(p.x - 0.1 * p.z, p.y) - 3;
  const double spread = 0.35 * p.z;
  const double fork =
      std::min(std::hypot(p.x - 0.1 * p.z - spread, p.y), std::hypot(p.x - 0.1 * p.z + spread, p.y)) - 2.2;
  return p.z < 0 ? trunk : fork;
}

struct Angiogram {
  CtVolume ct;
  Mask truth;
};

/// Grey values blurred over about a voxel, with noise.
Angiogram angiogram(double noise_hu) {
  Grid grid;
  grid.size = {44, 36, 40};
  grid.spacing_mm = {0.5, 0.5, 0.6};
  grid.origin_mm = {-11, -9, -12};
  Angiogram result{CtVolume(grid), Mask(grid)};
  std::uint32_t state = 7;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const double distance =
            artery(lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
        state = state * 1664525U + 1013904223U;
        const double noise = (static_cast<double>(state >> 8U) / 16777216.0 - 0.5) * 3.46 * noise_hu;
        result.ct(i, j, k) = static_cast<std::int16_t>(50 + 300 / (1 + std::exp(distance / 0.2)) + noise);
        result.truth(i, j, k) = distance < 0;
      }
  return result;
}

double dice(const Mask& a, const Mask& b) {
  return 2.0 * static_cast<double>(image::count(image::intersect(a, b))) /
         static_cast<double>(image::count(a) + image::count(b));
}

const Vec3 seed{-0.6, 0, -6};

TEST(VesselSnakes, FollowAForkInOnePiece) {
  for (const double noise : {0.0, 22.0}) {
    const Angiogram image = angiogram(noise);
    const Mask lumen = segment_vessel_by_snakes(image.ct, seed);
    EXPECT_GT(dice(lumen, image.truth), noise > 0 ? 0.93 : 0.95) << noise;
    EXPECT_EQ(image::connected_components(lumen).voxel_count.size(), 2U);
  }
}

TEST(VesselSnakes, MistakesAreUserErrors) {
  const Angiogram image = angiogram(0);
  EXPECT_THROW(segment_vessel_by_snakes(image.ct, {9, 8, 0}), UserError);
  EXPECT_THROW(segment_vessel_by_snakes(image.ct, {500, 0, 0}), UserError);
  EXPECT_THROW(segment_vessel_by_snakes(image.ct, seed, {.maximum_volume_ml = 0.1}), UserError);
}

}  // namespace
}  // namespace heartgen
