// SPDX-License-Identifier: GPL-3.0-or-later
// Grey values, thresholds, walls and pieces of small volumes whose parts are known.
#include "generator/naming/pieces.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "generator/chest/working_image.hpp"
#include "generator/image/gaussian.hpp"
#include "model/mathematics.hpp"

namespace heartgen::naming {
namespace {

Grid box_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  Grid grid;
  grid.size = {x, y, z};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  return grid;
}

/// A room full of what `hu` says, muscle of 100 HU at the rim.
template <class Grey>
Scene scene_of(const Grid& grid, Grey&& hu) {
  Scene scene;
  scene.hu = Volume<float>(grid);
  chest::for_each_voxel(grid, [&](const Vec3& p, std::size_t v) { scene.hu.voxels[v] = static_cast<float>(hu(p)); });
  scene.smooth = image::gaussian(scene.hu, 1.2);
  scene.smoother = image::gaussian(scene.hu, 2);
  scene.room = Mask(grid, 1);
  scene.room_depth_mm = Volume<float>(grid, 40);
  scene.view.end = grid.size;
  return scene;
}

constexpr double muscle = 100, blood = 350;
constexpr Levels known{200, blood, muscle};

std::int32_t count_in(const Pieces& pieces) { return static_cast<std::int32_t>(pieces.level.size()) - 1; }

std::int32_t piece_at(const Pieces& pieces, const Vec3& p) {
  const auto at = chest::nearest_voxel(pieces.label.grid, p);
  return pieces.label(at[0], at[1], at[2]);
}

Pieces cut(const Scene& scene) { return cut_into_pieces(scene, known, find_walls(scene, known)); }

TEST(Levels, AreThoseOfDeepBloodAndOfTheMuscleAroundIt) {
  const Vec3 middle{60, 60, 60};
  const auto scene = scene_of(box_of(61, 61, 61), [&](const Vec3& p) { return norm(p - middle) < 30 ? 370 : 95; });
  const auto levels = find_levels(scene.smooth, scene.room);
  EXPECT_TRUE(levels.has_contrast());
  EXPECT_NEAR(levels.blood_hu, 370, 2);
  EXPECT_NEAR(levels.muscle_hu, 95, 12);
}

TEST(Levels, NoContrastIsNone) {
  const auto scene = scene_of(box_of(61, 61, 61), [](const Vec3&) { return 50; });
  EXPECT_FALSE(find_levels(scene.smooth, scene.room).has_contrast());
}

/// Chambers of 350 and 180 HU: no threshold lies within 15 HU of either.
TEST(Thresholds, KeepOffTheChambersGreyValues) {
  std::vector<float> flat;
  for (int n = -20; n <= 20; ++n)
    for (const double level : {muscle, 180., blood})
      for (int times = 0; times < 40 - std::abs(n); ++times) flat.push_back(static_cast<float>(level + 0.5 * n));
  const auto found = thresholds(flat, known, 10);
  ASSERT_GE(found.size(), 2U);
  for (const double t : found)
    for (const double level : {180., blood}) EXPECT_GT(std::abs(t - level), 15) << t;
  EXPECT_TRUE(std::is_sorted(found.rbegin(), found.rend()));
  EXPECT_GT(found.back(), muscle);
}

TEST(GreyClosing, FillsNarrowValleysAlone) {
  const auto narrow_and_wide = [](const Vec3& p) {
    const bool narrow = std::abs(p.x - 20) < 3, wide = std::abs(p.x - 50) < 10;
    return narrow || wide ? muscle : blood;
  };
  const auto scene = scene_of(box_of(40, 20, 20), narrow_and_wide);
  const auto closed = grey_closing(scene.hu, 6);
  EXPECT_EQ(closed(10, 10, 10), static_cast<float>(blood));
  EXPECT_EQ(closed(25, 10, 10), static_cast<float>(muscle));
}

/// Two pools of one grey value with 3 mm of muscle between them, which at 2 mm is no muscle any more.
TEST(Pieces, AreDividedByAThinSeptum) {
  const auto grey = [](const Vec3& p) {
    const bool inside = std::abs(p.y - 40) < 26 && std::abs(p.z - 40) < 26 && p.x > 10 && p.x < 90;
    const double septum = std::clamp(1 - (std::abs(p.x - 50) - 0.5) / 2, 0.0, 1.0);
    return inside ? blood - 0.75 * (blood - muscle) * septum : muscle;
  };
  const auto pieces = cut(scene_of(box_of(51, 41, 41), grey));
  EXPECT_NE(piece_at(pieces, {30, 40, 40}), 0);
  EXPECT_NE(piece_at(pieces, {70, 40, 40}), 0);
  EXPECT_NE(piece_at(pieces, {30, 40, 40}), piece_at(pieces, {70, 40, 40}));
}

/// One pool of two grey values, each as deep as the other.
TEST(Pieces, AreDividedWhereTheGreyValueSteps) {
  const auto grey = [](const Vec3& p) {
    const bool inside = std::abs(p.y - 40) < 26 && std::abs(p.z - 40) < 26 && p.x > 10 && p.x < 90;
    return !inside ? muscle : p.x < 50 ? blood : blood + 120;
  };
  const auto pieces = cut(scene_of(box_of(51, 41, 41), grey));
  EXPECT_NE(piece_at(pieces, {30, 40, 40}), 0);
  EXPECT_NE(piece_at(pieces, {30, 40, 40}), piece_at(pieces, {70, 40, 40}));
}

TEST(Pieces, AWholePoolIsOne) {
  const auto grey = [](const Vec3& p) { return norm(p - Vec3{40, 40, 40}) < 28 ? blood : muscle; };
  const auto pieces = cut(scene_of(box_of(41, 41, 41), grey));
  EXPECT_EQ(count_in(pieces), 1);
}

/// A chamber with less contrast is found by a lower threshold; its rim is none of the brighter one's.
TEST(Pieces, OfWeakBloodComeFromALowerLevel) {
  const auto grey = [](const Vec3& p) {
    if (norm(p - Vec3{40, 50, 50}) < 26) return blood;
    return norm(p - Vec3{110, 50, 50}) < 26 ? 190. : muscle;
  };
  const auto pieces = cut(scene_of(box_of(76, 51, 51), grey));
  const auto bright = piece_at(pieces, {40, 50, 50}), weak = piece_at(pieces, {110, 50, 50});
  ASSERT_NE(bright, 0);
  ASSERT_NE(weak, 0);
  EXPECT_GT(pieces.level[static_cast<std::size_t>(bright)], pieces.level[static_cast<std::size_t>(weak)]);
  EXPECT_EQ(count_in(pieces), 2);
}

/// A trunk of 20 mm that widens into a ball of 60 mm has no neck.
TEST(Pieces, ATrunkIsCutOff) {
  const Grid grid = box_of(80, 51, 51);
  image::Basins basins;
  basins.label = Volume<std::int32_t>(grid);
  chest::for_each_voxel(grid, [&](const Vec3& p, std::size_t v) {
    const bool ball = norm(p - Vec3{50, 50, 50}) < 32;
    const bool trunk = p.x > 50 && p.x < 150 && math::hypot(p.y - 50, p.z - 50) < 10;
    basins.label.voxels[v] = ball || trunk;
  });
  basins.depth_mm =
      chest::depth_of(chest::mask_where(grid, [&](const Vec3&, std::size_t v) { return basins.label.voxels[v] > 0; }));
  basins.count = 1;
  cut_off_trunks(basins);
  EXPECT_EQ(basins.count, 2);
  EXPECT_EQ(basins.label(25, 25, 25), 1);
  EXPECT_EQ(basins.label(60, 25, 25), 2);
}

}  // namespace
}  // namespace heartgen::naming
