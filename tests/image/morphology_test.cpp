// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/morphology.hpp"

#include <gtest/gtest.h>

#include "generator/image/distance.hpp"

namespace heartgen::image {
namespace {

Mask ball(double radius_mm) {
  Grid grid;
  grid.size = {41, 33, 25};
  grid.spacing_mm = {0.8, 1, 1.4};
  Mask mask(grid);
  const Vec3 center = lps_from_index(grid, {20, 16, 12});
  for (std::int64_t k = 0; k < 25; ++k)
    for (std::int64_t j = 0; j < 33; ++j)
      for (std::int64_t i = 0; i < 41; ++i)
        mask(i, j, k) =
            norm(lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}) -
                 center) <= radius_mm;
  return mask;
}

TEST(Morphology, DilationOfAPointIsTheBall) { EXPECT_EQ(image::dilate(ball(0.1), 6.05).voxels, ball(6.05).voxels); }

/// Small balls are laid row by row, large ones by a distance transform: both reach what is near enough, no more.
TEST(Morphology, DilationReachesWhatIsWithinTheRadius) {
  Mask mask = ball(0.1);
  mask(3, 30, 2) = mask(40, 0, 24) = mask(17, 16, 12) = 1;
  const auto distance = image::distance_to(mask);
  for (const double radius : {0.5, 0.8, 1.0, 2.4, 5.0, 11.0, 19.0, 40.0}) {
    const Mask found = image::dilate(mask, radius);
    for (std::size_t v = 0; v < found.voxels.size(); ++v)
      ASSERT_EQ(found.voxels[v] != 0, static_cast<double>(distance.voxels[v]) <= radius + 1e-4) << radius;
  }
}

TEST(Morphology, ErosionIsTheDilationOfTheComplement) {
  const Mask eroded = image::erode(ball(9), 4);
  EXPECT_GT(image::count(eroded), 0);
  EXPECT_EQ(image::count(image::subtract(eroded, ball(6.4))), 0);
  EXPECT_EQ(image::count(image::subtract(image::dilate(eroded, 4), ball(9))), 0);
}

/// Also where the mask reaches the image's border, beyond which nothing is unset.
TEST(Morphology, ErosionKeepsWhatIsFarEnoughFromAllThatIsUnset) {
  Mask mask = ball(14), unset(mask.grid);
  mask(3, 30, 2) = mask(40, 0, 24) = 1;
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) unset.voxels[v] = mask.voxels[v] == 0;
  const auto depth = image::distance_to(unset);
  for (const double radius : {0.5, 0.8, 1.0, 2.4, 5.0, 11.0}) {
    const Mask found = image::erode(mask, radius);
    for (std::size_t v = 0; v < found.voxels.size(); ++v)
      ASSERT_EQ(found.voxels[v] != 0, static_cast<double>(depth.voxels[v]) > radius + 1e-4) << radius;
  }
}

TEST(Morphology, OpeningRemovesWhatIsThinnerThanTheBall) {
  Mask mask = ball(8);
  for (std::int64_t i = 0; i < 41; ++i) mask(i, 16, 12) = 1;
  EXPECT_EQ(image::count(image::intersect(image::open(mask, 3), image::subtract(mask, ball(8.01)))), 0);
  EXPECT_EQ(image::count(image::open(ball(2), 3)), 0);
}

TEST(Morphology, ClosingFillsGapsAndContainsTheMask) {
  Mask mask = ball(8);
  mask(20, 16, 12) = 0;
  const Mask closed = image::close(mask, 3);
  EXPECT_EQ(closed(20, 16, 12), 1);
  EXPECT_EQ(image::count(image::subtract(mask, closed)), 0);
}

TEST(Morphology, TheBorderContinues) {
  Grid grid;
  grid.size = {6, 6, 6};
  EXPECT_EQ(image::count(image::erode(Mask(grid, 1), 3)), 216);
}

}  // namespace
}  // namespace heartgen::image
