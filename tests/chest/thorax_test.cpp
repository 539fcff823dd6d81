// SPDX-License-Identifier: GPL-3.0-or-later
// Lungs, the room between them and the spine of a chest made of ellipsoids.
#include "generator/chest/thorax.hpp"

#include <gtest/gtest.h>

#include "generator/chest/spine.hpp"
#include "generator/chest/trachea.hpp"
#include "generator/chest/working_image.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::chest {
namespace {

constexpr double spine_x = 150, spine_y = 190;

/// A body of 300 x 240 x 240 mm: two lungs, vertebrae between their backs, a trachea above.
float grey(const Vec3& p) {
  const auto ellipse = [&](double x, double y, double rx, double ry) {
    return math::hypot((p.x - x) / rx, (p.y - y) / ry) < 1;
  };
  if (!ellipse(150, 120, 148, 118)) return -1000;
  if (ellipse(spine_x, spine_y, 18, 15)) return 230;
  if (p.z > 140 && ellipse(150, 140, 9, 9)) return -990;
  if (ellipse(75, 130, 45, 85) || ellipse(225, 130, 45, 85)) return -850;
  return 40;
}

Volume<float> chest_image() {
  Grid grid;
  grid.size = {101, 81, 81};
  grid.spacing_mm = {3, 3, 3};
  Volume<float> image(grid);
  for_each_voxel(grid, [&](const Vec3& p, std::size_t v) { image.voxels[v] = grey(p); });
  return image;
}

TEST(Thorax, HasTwoLungsARoomBetweenThemAndASpine) {
  const auto image = chest_image();
  const auto thorax = find_thorax(image);
  EXPECT_TRUE(thorax.lung(25, 43, 40));
  EXPECT_TRUE(thorax.lung(75, 43, 40));
  EXPECT_FALSE(thorax.lung(50, 43, 40));
  EXPECT_TRUE(thorax.chest(50, 43, 40));
  EXPECT_FALSE(thorax.back_is_cut);
  for (const double z : {30., 120., 210.}) {
    EXPECT_NEAR(thorax.spine.at(z).x, spine_x, 6);
    EXPECT_NEAR(thorax.spine.at(z).y, spine_y, 8);
  }
  EXPECT_LT(share_unlike_spine(thorax.spine, image, thorax.lung, 400), 0.1);
}

TEST(Thorax, WithoutLungsIsNone) {
  auto image = chest_image();
  for (auto& hu : image.voxels) hu = std::max(hu, 30.F);
  EXPECT_THROW(find_thorax(image), UserError);
}

TEST(Trachea, IsAChainOfDiscsInFrontOfTheSpine) {
  const auto image = chest_image();
  const auto trachea = find_trachea(image, find_thorax(image).spine);
  ASSERT_TRUE(trachea.has_value());
  EXPECT_NEAR(trachea->x, 150, 2);
  EXPECT_NEAR(trachea->y, 140, 2);
  EXPECT_GT(trachea->z, 140);
}

}  // namespace
}  // namespace heartgen::chest
