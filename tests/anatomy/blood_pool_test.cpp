// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/blood_pool.hpp"

#include <gtest/gtest.h>

#include "anatomy/toy_heart.hpp"

namespace heartgen::anatomy {
namespace {

/// The right ventricle's blood reaches around more than half of the left one, behind a septum of 3 mm.
ToyHeart wrapped_heart(double right_hu) {
  ToyHeart heart = toy_heart({.left_hu = 420, .right_hu = right_hu, .noise_hu = 15});
  const auto& size = heart.ct.grid.size;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        const Vec3 at =
            lps_from_index(heart.ct.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const bool wall = heart.truth.voxels[v] == tag(Region::lv_myocardium);
        if (wall && at.x < 24 && !toy::in_ball(at, toy::lv, 19)) heart.ct.voxels[v] += right_hu - 110;
      }
  return heart;
}

/// Its blood is nearer to muscle than to the left heart's blood: not to be taken for muscle.
TEST(BloodPool, MuscleIsMeasuredAwayFromTheRightHeart) {
  for (const double right_hu : {190.0, 230.0}) {
    const ToyHeart heart = wrapped_heart(right_hu);
    EXPECT_NEAR(anatomy::find_blood(heart.ct, heart.landmarks, 90).muscle_hu, 110, 6) << right_hu;
  }
}

}  // namespace
}  // namespace heartgen::anatomy
