// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/chambers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "anatomy/toy_heart.hpp"
#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/morphology.hpp"
#include "model/error.hpp"
#include "support/places.hpp"

namespace heartgen::anatomy {
namespace {

LabelVolume chambers_of(const ToyHeart& heart, const ChamberSettings& settings = {}) {
  return anatomy::split_chambers(heart.ct, heart.tree, heart.landmarks, settings);
}

std::string error_of(const ToyHeart& heart) {
  try {
    chambers_of(heart);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Chambers, AreFoundAndEndAtTheValves) {
  const ToyHeart heart = toy_heart();
  const auto labels = chambers_of(heart);
  for (const Region region : {Region::lv_blood, Region::rv_blood, Region::la_blood, Region::ra_blood})
    EXPECT_GT(dice(labels, heart.truth, region), 0.95) << region_name(tag(region));
}

TEST(Chambers, AWeaklyEnhancedRightHeartIsFoundToo) {
  const ToyHeart heart = toy_heart({.left_hu = 450, .right_hu = 190, .noise_hu = 20});
  const auto labels = chambers_of(heart);
  for (const Region region : {Region::lv_blood, Region::rv_blood, Region::la_blood, Region::ra_blood})
    EXPECT_GT(dice(labels, heart.truth, region), 0.93) << region_name(tag(region));
}

/// Late phases: contrast is low everywhere, and the right heart nearly as bright as the left one.
TEST(Chambers, LowContrastOnBothSidesIsNoFaintRightHeart) {
  for (const auto& [left_hu, right_hu] : {std::pair{240.0, 185.0}, std::pair{200.0, 175.0}}) {
    const ToyHeart heart = toy_heart({.left_hu = left_hu, .right_hu = right_hu, .noise_hu = 8});
    const auto labels = chambers_of(heart);
    for (const Region region : {Region::lv_blood, Region::rv_blood, Region::la_blood, Region::ra_blood})
      EXPECT_GT(dice(labels, heart.truth, region), 0.93) << region_name(tag(region)) << " at " << left_hu << " HU";
  }
}

/// Right blood brighter than muscle (110 HU), darker, and as bright: its walls have usual thickness, as the toy's do.
class FaintRightHeart : public ::testing::TestWithParam<double> {};

TEST_P(FaintRightHeart, IsFoundBesideTheLeftOne) {
  const ToyHeart heart = toy_heart({.left_hu = 420, .right_hu = GetParam(), .noise_hu = 15});
  const auto labels = chambers_of(heart);
  for (const Region region : {Region::lv_blood, Region::la_blood})
    EXPECT_GT(dice(labels, heart.truth, region), 0.95) << region_name(tag(region));
  for (const Region region : {Region::rv_blood, Region::ra_blood})
    EXPECT_GT(dice(labels, heart.truth, region), 0.9) << region_name(tag(region));
}

INSTANTIATE_TEST_SUITE_P(Contrasts, FaintRightHeart, ::testing::Values(70, 110, 150));

/// Noise hides what single grey values say; together with usual walls they say more.
TEST(Chambers, ModerateContrastInNoiseIsHelpedByUsualWalls) {
  const ToyHeart heart = toy_heart({.left_hu = 420, .right_hu = 190, .noise_hu = 25});
  const auto labels = chambers_of(heart);
  for (const Region region : {Region::rv_blood, Region::ra_blood})
    EXPECT_GT(dice(labels, heart.truth, region), 0.985) << region_name(tag(region));
}

/// The heart's fat within 4 mm, lungs around it, and a plate of muscle before them that the right ventricle's wall
/// touches; air of the room before that.
void put_into_chest(ToyHeart& heart) {
  constexpr double touch_mm = -17, skin_mm = -27, fat_mm = 4;
  Mask structures(heart.ct.grid);
  for (std::size_t v = 0; v < structures.voxels.size(); ++v) structures.voxels[v] = heart.truth.voxels[v] != 0;
  const Volume<float> off = image::distance_to(structures);
  for (std::size_t v = 0; v < structures.voxels.size(); ++v) {
    const Vec3 p = testing::lps_of_voxel(heart.ct.grid, static_cast<std::int64_t>(v));
    if (p.y < skin_mm)
      heart.ct.voxels[v] = -1000;
    else if (p.y < touch_mm && heart.truth.voxels[v] == 0)
      heart.ct.voxels[v] = 110;
    else if (static_cast<double>(off.voxels[v]) > fat_mm)
      heart.ct.voxels[v] = -850;
  }
}

TEST_P(FaintRightHeart, DoesNotRunOutIntoTheChestWall) {
  ToyHeart heart = toy_heart({.left_hu = 420, .right_hu = GetParam(), .noise_hu = 15});
  put_into_chest(heart);
  const auto labels = chambers_of(heart);
  EXPECT_GT(dice(labels, heart.truth, Region::rv_blood), 0.8);
  EXPECT_GT(dice(labels, heart.truth, Region::ra_blood), 0.93);
}

TEST(Chambers, ALargeHeartIsSearchedAsFarAsItsApexTells) {
  ToyHeart heart = toy_heart();
  ChamberSettings settings;
  settings.heart_radius_mm = 31;  // the right ventricle reaches 36 mm
  EXPECT_LT(dice(chambers_of(heart, settings), heart.truth, Region::rv_blood), 0.99);
  heart.landmarks.lv_apex_mm = Vec3{20, -25, -45};
  EXPECT_GT(dice(chambers_of(heart, settings), heart.truth, Region::rv_blood), 0.995);
}

TEST(Chambers, TheWholeAortaIsKeptWhereItsLengthIsZero) {
  const ToyHeart heart = toy_heart();
  ChamberSettings settings;
  settings.vessel_length_mm = 0;
  EXPECT_GT(dice(chambers_of(heart, settings), heart.truth, Region::aorta), 0.9);
}

TEST(Chambers, TheAortaIsCutAtItsLength) {
  const ToyHeart heart = toy_heart();
  ChamberSettings settings;
  settings.vessel_length_mm = 12;
  const auto labels = chambers_of(heart, settings);
  const auto at = [&](double y) {
    const Vec3 index = index_from_lps(labels.grid, {20, y, -10});
    return labels(std::lround(index.x), std::lround(index.y), std::lround(index.z));
  };
  EXPECT_EQ(at(14), tag(Region::lv_blood));
  EXPECT_EQ(at(22), tag(Region::aorta));
  EXPECT_EQ(at(35), 0);
}

TEST(Chambers, PapillaryMusclesAreKeptOrClosed) {
  ToyHeart heart = toy_heart();
  const Vec3 tip{28, -8, -14};
  for (std::int64_t v = 0; v < heart.ct.grid.voxel_count(); ++v) {
    const Vec3 p = testing::lps_of_voxel(heart.ct.grid, v);
    if (norm(p - tip) < 4.5) heart.ct.voxels[static_cast<std::size_t>(v)] = 110;
  }
  const Vec3 index = index_from_lps(heart.ct.grid, tip);
  const Index3 at{std::lround(index.x), std::lround(index.y), std::lround(index.z)};
  EXPECT_EQ(chambers_of(heart)(at[0], at[1], at[2]), tag(Region::papillary));
  ChamberSettings settings;
  settings.close_trabeculae_mm = 6;
  EXPECT_EQ(chambers_of(heart, settings)(at[0], at[1], at[2]), tag(Region::lv_blood));
}

TEST(Chambers, MuscleBesideTheFatOfANotchIsWallAndNotPapillary) {
  ToyHeart heart = toy_heart();
  Mask fat(heart.ct.grid);
  for (std::int64_t v = 0; v < heart.ct.grid.voxel_count(); ++v) {
    const Vec3 p = testing::lps_of_voxel(heart.ct.grid, v);
    if (norm(p - toy::rv) > 19 || p.x > -27 || std::abs(p.z + 10) > 5) continue;
    fat.voxels[static_cast<std::size_t>(v)] = p.x < -30 && std::abs(p.z + 10) < 2;
    heart.ct.voxels[static_cast<std::size_t>(v)] = fat.voxels[static_cast<std::size_t>(v)] ? -90 : 110;
  }
  const auto labels = chambers_of(heart);
  const Mask beside_fat = image::dilate(fat, 2);
  std::int64_t papillary = 0;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    papillary += beside_fat.voxels[v] && labels.voxels[v] == tag(Region::papillary);
  EXPECT_EQ(papillary, 0);
}

TEST(Chambers, PoolsWithoutAValveBetweenThemNeverTouch) {
  ToyHeart heart = toy_heart();
  const auto [nx, ny, nz] = heart.ct.grid.size;
  // A channel between the atria, as if their wall were lost.
  for (std::int64_t v = 0; v < heart.ct.grid.voxel_count(); ++v) {
    const Vec3 p = testing::lps_of_voxel(heart.ct.grid, v);
    if (std::abs(p.x) < 15 && std::hypot(p.y, p.z - 23) < 5) heart.ct.voxels[static_cast<std::size_t>(v)] = 350;
  }
  const auto labels = chambers_of(heart);
  const auto at = [&](std::int64_t i, std::int64_t j, std::int64_t k) { return labels(i, j, k); };
  std::int64_t contacts = 0, channel = 0;
  for (std::int64_t k = 0; k + 1 < nz; ++k)
    for (std::int64_t j = 0; j + 1 < ny; ++j)
      for (std::int64_t i = 0; i + 1 < nx; ++i)
        for (const auto& [x, y, z] : {Index3{i + 1, j, k}, {i, j + 1, k}, {i, j, k + 1}}) {
          const auto low = std::min(at(i, j, k), at(x, y, z)), high = std::max(at(i, j, k), at(x, y, z));
          contacts += low == tag(Region::la_blood) && high == tag(Region::ra_blood);
          channel += high == tag(Region::la_blood) || high == tag(Region::ra_blood);
        }
  EXPECT_EQ(contacts, 0);
  EXPECT_GT(channel, 0);
}

TEST(Chambers, WrongSeedsAreNamed) {
  ToyHeart heart = toy_heart();
  heart.landmarks.seeds_mm.erase("ra_blood");
  EXPECT_NE(error_of(heart).find("ra_blood"), std::string::npos);
  heart = toy_heart();
  heart.landmarks.seeds_mm["la_blood"] = {20, 0, 400};
  EXPECT_NE(error_of(heart).find("la_blood at (20.0, 0.0, 400.0)"), std::string::npos);
  heart = toy_heart();
  heart.landmarks.seeds_mm["rv_blood"] = {-40, -25, -30};  // in fat
  EXPECT_NE(error_of(heart).find("rv_blood"), std::string::npos);
  EXPECT_NE(error_of(heart).find("HU"), std::string::npos);
}

}  // namespace
}  // namespace heartgen::anatomy
