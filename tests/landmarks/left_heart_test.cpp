// SPDX-License-Identifier: GPL-3.0-or-later
// The left heart among basins and pools written down by hand.
#include "generator/landmarks/left_heart.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace heartgen::landmarks {
namespace {

enum Label : std::int32_t { aorta = 1, atrium, base, apex };

const chest::Spine spine{-100, 200, {0, 0}, {80, 80}};

Pool pool(double volume_ml, const Vec3& centre_mm, double muscle_share) {
  Pool p;
  p.volume_ml = volume_ml;
  p.centre_mm = centre_mm;
  p.top_mm = centre_mm.z + 20;
  p.bottom_mm = centre_mm.z - 20;
  p.depth_mm = 13;
  p.muscle_share = muscle_share;
  p.left_mm = centre_mm.x - spine.x_mm.front();
  p.front_mm = spine.y_mm.front() - centre_mm.y;
  return p;
}

struct Heart {
  image::Basins basins;
  Pools pools;
};

/// A ventricle whose papillary muscles part the apex from the base.
Heart heart_with_parted_apex(double base_muscle_share) {
  Heart heart;
  heart.basins.label.grid.size = {0, 0, 0};
  heart.basins.count = 4;
  heart.basins.contacts = {{{atrium, base}, {11, 300}}, {{aorta, base}, {8, 200}}, {{base, apex}, {9, 250}}};
  heart.pools = {{aorta, pool(95, {8, -20, 60}, 0.18)},
                 {atrium, pool(70, {20, 15, 20}, 0.22)},
                 {base, pool(32, {54, -2, 0}, base_muscle_share)},
                 {apex, pool(21, {75, -26, -6}, 0.65)}};
  return heart;
}

TEST(LeftHeart, PapillaryMusclesDoNotPartTheApexFromTheBase) {
  for (const double muscle_share : {0.6, 0.45}) {
    const Heart heart = heart_with_parted_apex(muscle_share);
    const auto left = find_left_heart(heart.basins, heart.pools, spine);
    ASSERT_TRUE(left.has_value()) << muscle_share;
    auto ventricle = left->ventricle;
    std::sort(ventricle.begin(), ventricle.end());
    EXPECT_EQ(ventricle, (std::vector<std::int32_t>{base, apex})) << muscle_share;
    EXPECT_EQ(left->atrium, atrium) << muscle_share;
    EXPECT_EQ(left->aorta, aorta) << muscle_share;
    EXPECT_GT(left->certainty, 0.4) << muscle_share;
  }
}

TEST(LeftHeart, AnAtriumIsNoBase) {
  const Heart heart = heart_with_parted_apex(0.25);
  EXPECT_FALSE(find_left_heart(heart.basins, heart.pools, spine).has_value());
}

}  // namespace
}  // namespace heartgen::landmarks
