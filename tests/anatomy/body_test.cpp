// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/body.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "generator/anatomy/fuse_labels.hpp"
#include "generator/anatomy/trachea.hpp"
#include "generator/anatomy/vessel.hpp"
#include "generator/image/morphology.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen::anatomy {
namespace {

/// A chest of cylinders on a table: skin radius 60 mm, two lungs, a trachea that splits into them, a spine.
struct ToyChest {
  CtVolume ct;
  LabelVolume truth;
  LabelVolume chambers;
  pde::SegmentationTree tree;
};

Region chest_region(const Vec3& p) {
  if (std::hypot(p.x, p.y) > 60) return Region::none;
  if (p.z > 10 && std::hypot(p.x, p.y - 5) < 8) return Region::trachea;
  if (std::abs(p.z) < 40 && std::hypot(std::abs(p.x) - 30, p.y) < 18) return Region::lung;
  if (std::hypot(p.x, p.y - 38) < 12) return Region::bone;
  return Region::torso;
}

double chest_grey(const Vec3& p, Region region) {
  switch (region) {
    case Region::none:
      return std::abs(p.y - 66) < 2.5 ? 100 : -1000;  // the table
    case Region::trachea:
      return -1000;
    case Region::lung:
      return -850;
    case Region::bone:
      return std::hypot(p.x, p.y - 38) > 9 ? 700 : 230;
    default:
      return 40;
  }
}

ToyChest toy_chest() {
  Grid grid;
  grid.size = {70, 72, 50};
  grid.spacing_mm = {2, 2, 2.2};
  grid.origin_mm = {-69, -65, -55};
  ToyChest chest{CtVolume(grid), LabelVolume(grid), LabelVolume(grid), {}};
  pde::SegmentationSide step{"body", Mask(grid), Mask(grid), -980, 40};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Vec3 p = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const Region region = chest_region(p);
        chest.truth.voxels[v] = tag(region);
        chest.ct.voxels[v] = static_cast<std::int16_t>(chest_grey(p, region));
        step.above.voxels[v] = chest.ct.voxels[v] > -470;
        step.below.voxels[v] = !step.above.voxels[v];
      }
  chest.tree = {step};
  return chest;
}

double overlap(const Mask& mask, const LabelVolume& truth, Region region) {
  std::int64_t both = 0, sum = 0;
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) {
    const bool in = truth.voxels[v] == tag(region);
    both += mask.voxels[v] && in;
    sum += (mask.voxels[v] != 0) + in;
  }
  return 2.0 * static_cast<double>(both) / static_cast<double>(sum);
}

/// LPS position of the centre of the n-th voxel in memory order.
Vec3 voxel_centre(const Grid& grid, std::int64_t n) {
  const std::int64_t i = n % grid.size[0], j = n / grid.size[0] % grid.size[1], k = n / (grid.size[0] * grid.size[1]);
  return lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
}

/// Replaces the chest's tissue within `radius_mm` of a vertical line by `grey_hu`.
void fill_column(ToyChest& chest, double x, double y, double radius_mm, std::int16_t grey_hu) {
  std::size_t v = 0;
  for (std::int64_t k = 0; k < chest.ct.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < chest.ct.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < chest.ct.grid.size[0]; ++i, ++v) {
        const Vec3 p =
            lps_from_index(chest.ct.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        if (std::hypot(p.x - x, p.y - y) < radius_mm && chest.truth.voxels[v] == tag(Region::torso))
          chest.ct.voxels[v] = grey_hu;
      }
}

TEST(Body, ContrastBesideTheSpineIsNoBone) {
  for (const std::int16_t grey : {std::int16_t{200}, std::int16_t{330}, std::int16_t{2500}}) {
    ToyChest chest = toy_chest();
    fill_column(chest, 0, 14, 9, grey);     // a vessel in front of the spine, 3 mm from it
    fill_column(chest, -20, 38, 11, grey);  // an organ that touches it
    const auto body = anatomy::segment_body(chest.ct, chest.tree, chest.chambers, {}, {});
    EXPECT_GT(overlap(body.bone, chest.truth, Region::bone), 0.85) << grey;
    std::int64_t wrong = 0, contrast = 0;
    for (std::size_t v = 0; v < body.bone.voxels.size(); ++v) {
      const bool here = chest.truth.voxels[v] == tag(Region::torso) && chest.ct.voxels[v] == grey;
      contrast += here;
      wrong += here && body.bone.voxels[v];
    }
    EXPECT_GT(contrast, 5000);
    EXPECT_LT(6 * wrong, contrast) << grey;  // what touches the bone with its own grey value may stay with it
  }
}

TEST(Body, AnArteryByItselfIsNoBoneAndARibByItselfIs) {
  ToyChest chest = toy_chest();
  constexpr std::int16_t blood = 380;
  fill_column(chest, 0, 14, 9, blood);   // the heart's blood
  fill_column(chest, 0, -40, 4, blood);  // an artery that nothing joins to it
  fill_column(chest, 44, -28, 5, 650);   // a rib: marrow in a shell
  fill_column(chest, 44, -28, 3, 200);
  std::int64_t artery = 0, rib = 0, artery_as_bone = 0, rib_as_bone = 0;
  std::vector<std::uint8_t> place(chest.ct.voxels.size(), 0);
  const auto& size = chest.ct.grid.size;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        const Vec3 p =
            lps_from_index(chest.ct.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        if (chest.truth.voxels[v] != tag(Region::torso)) continue;
        if (std::hypot(p.x, p.y - 14) < 9) chest.chambers.voxels[v] = tag(Region::lv_blood);
        if (std::hypot(p.x, p.y + 40) < 4) place[v] = 1;
        if (std::hypot(p.x - 44, p.y + 28) < 5) place[v] = 2;
      }
  const auto body = anatomy::segment_body(chest.ct, chest.tree, chest.chambers, {}, {});
  for (v = 0; v < place.size(); ++v) {
    artery += place[v] == 1, artery_as_bone += place[v] == 1 && body.bone.voxels[v];
    rib += place[v] == 2, rib_as_bone += place[v] == 2 && body.bone.voxels[v];
  }
  EXPECT_GT(artery, 500);
  EXPECT_LT(20 * artery_as_bone, artery);
  EXPECT_GT(2 * rib_as_bone, rib);
}

enum class Spine { none, shell, marrow, canal };

/// Vertebrae 26 mm apart along a curved spine, each a body with end plates and an arch that leaves room above it.
Spine spine_part(const Vec3& p) {
  const double bend = 5 * std::sin(p.z / 35), level = std::abs(std::remainder(p.z, 26.0));
  const double in_body = std::hypot(p.x, p.y - 27 - bend), in_arch = std::hypot(p.x, p.y - 44 - bend);
  if (in_arch < 6.5) return Spine::canal;
  if (in_arch < 10 && level < 8) return Spine::shell;
  if (in_body > 12 || level > 10.5) return Spine::none;
  return in_body > 9 || level > 7.5 ? Spine::shell : Spine::marrow;
}

TEST(Body, MarrowIsBoneAndTheSpinalCanalIsNotThoughAsDark) {
  ToyChest chest = toy_chest();
  std::vector<Spine> part(chest.ct.voxels.size(), Spine::none);
  for (std::int64_t n = 0; n < chest.ct.grid.voxel_count(); ++n) {
    const auto v = static_cast<std::size_t>(n);
    const Vec3 p = voxel_centre(chest.ct.grid, n);
    if (chest.truth.voxels[v] == tag(Region::bone)) chest.ct.voxels[v] = 40;  // in place of the plain spine
    part[v] = spine_part(p);
    if (part[v] != Spine::none) chest.ct.voxels[v] = part[v] == Spine::shell ? 600 : 40;
  }
  const auto body = anatomy::segment_body(chest.ct, chest.tree, chest.chambers, {}, {});
  std::int64_t marrow = 0, canal = 0, marrow_as_bone = 0, canal_as_bone = 0;
  for (std::size_t v = 0; v < part.size(); ++v) {
    marrow += part[v] == Spine::marrow, marrow_as_bone += part[v] == Spine::marrow && body.bone.voxels[v];
    canal += part[v] == Spine::canal, canal_as_bone += part[v] == Spine::canal && body.bone.voxels[v];
  }
  EXPECT_GT(marrow, 1000);
  EXPECT_GT(10 * marrow_as_bone, 9 * marrow);
  EXPECT_GT(canal, 1000);
  EXPECT_LT(10 * canal_as_bone, canal);
}

TEST(Body, AVesselInTheLungIsNoBoneAndARibBesideTheLungIs) {
  ToyChest chest = toy_chest();
  std::int64_t vessel = 0, rib = 0, vessel_as_bone = 0, rib_as_bone = 0;
  std::vector<std::uint8_t> place(chest.ct.voxels.size(), 0);
  for (std::int64_t n = 0; n < chest.ct.grid.voxel_count(); ++n) {
    const auto v = static_cast<std::size_t>(n);
    const Vec3 p = voxel_centre(chest.ct.grid, n);
    const double from_vessel = std::hypot(p.x - 32, p.y), from_rib = std::hypot(p.x - 30, p.y + 22);
    if (p.z < 0 && from_vessel < 6) place[v] = 1;  // it leaves the lung below
    if (from_rib < 6 && chest.truth.voxels[v] == tag(Region::torso)) place[v] = 2;
    if (place[v] == 0) continue;
    chest.ct.voxels[v] = std::min(from_vessel, from_rib) < 4 ? 250 : 600;  // both look like bone
    chest.tree[0].above.voxels[v] = 1;
    if (p.z < -40 && place[v] == 1) chest.ct.voxels[v] = 40;
  }
  const auto body = anatomy::segment_body(chest.ct, chest.tree, chest.chambers, {}, {});
  for (std::size_t v = 0; v < place.size(); ++v) {
    vessel += place[v] == 1, vessel_as_bone += place[v] == 1 && body.bone.voxels[v];
    rib += place[v] == 2, rib_as_bone += place[v] == 2 && body.bone.voxels[v];
  }
  EXPECT_GT(vessel, 300);
  EXPECT_EQ(vessel_as_bone, 0);
  EXPECT_GT(2 * rib_as_bone, rib);
}

TEST(Body, SkinLungsAndBoneWithoutTheTable) {
  const ToyChest chest = toy_chest();
  const auto body = anatomy::segment_body(chest.ct, chest.tree, chest.chambers, {}, {});
  for (std::size_t v = 0; v < chest.truth.voxels.size(); ++v)
    EXPECT_EQ(body.body.voxels[v], chest.truth.voxels[v] != 0) << v;
  EXPECT_GT(overlap(body.lung, chest.truth, Region::lung), 0.95);
  EXPECT_GT(overlap(body.bone, chest.truth, Region::bone), 0.85);
}

TEST(Body, LungCutByTheFieldOfViewIsInside) {
  ToyChest chest = toy_chest();
  for (std::int64_t k = 0; k < 50; ++k)
    for (std::int64_t j = 0; j < 72; ++j) {
      chest.ct(0, j, k) = -850;  // the image ends inside a lung
      chest.tree[0].above(0, j, k) = 0;
      for (std::int64_t i = 1; i < 20; ++i) chest.ct(i, j, k) = -850, chest.tree[0].above(i, j, k) = 0;
    }
  EXPECT_EQ(anatomy::segment_body(chest.ct, chest.tree, chest.chambers, {}, {}).body(2, 36, 25), 1);
}

TEST(Body, NoTissueIsAUserError) {
  ToyChest chest = toy_chest();
  std::fill(chest.tree[0].above.voxels.begin(), chest.tree[0].above.voxels.end(), std::uint8_t{0});
  EXPECT_THROW(anatomy::segment_body(chest.ct, chest.tree, chest.chambers, {}, {}), UserError);
}

TEST(Body, TheLiverFollowsItsSeed) {
  ToyChest chest = toy_chest();
  LabelVolume truth = chest.truth;
  for (std::int64_t v = 0; v < truth.grid.voxel_count(); ++v) {
    const Vec3 p = voxel_centre(truth.grid, v);
    if (norm(p - Vec3{-5, -34, -10}) > 17) continue;
    truth.voxels[static_cast<std::size_t>(v)] = tag(Region::liver);
    chest.ct.voxels[static_cast<std::size_t>(v)] = 110;
  }
  Landmarks landmarks;
  EXPECT_EQ(image::count(anatomy::segment_body(chest.ct, chest.tree, chest.chambers, landmarks, {}).liver), 0);
  landmarks.seeds_mm["liver"] = {-5, -34, -10};
  EXPECT_GT(
      overlap(anatomy::segment_body(chest.ct, chest.tree, chest.chambers, landmarks, {}).liver, truth, Region::liver),
      0.9);
  landmarks.seeds_mm["liver"] = {-5, -34, -500};  // below the scan
  EXPECT_EQ(image::count(anatomy::segment_body(chest.ct, chest.tree, chest.chambers, landmarks, {}).liver), 0);
  landmarks.seeds_mm["liver"] = {-30, 0, 0};  // in the lung
  EXPECT_THROW(anatomy::segment_body(chest.ct, chest.tree, chest.chambers, landmarks, {}), UserError);
}

/// A liver of 30 mm radius whose dome stands in the lung of one side: -1 the patient's right one.
Mask liver_under_lung(double side, LabelVolume& truth) {
  ToyChest chest = toy_chest();
  for (std::int64_t v = 0; v < chest.truth.grid.voxel_count(); ++v) {
    const Vec3 p = voxel_centre(chest.truth.grid, v);
    if (norm(p - Vec3{28 * side, 0, -45}) > 30 || chest.truth.voxels[static_cast<std::size_t>(v)] == tag(Region::bone))
      continue;
    chest.truth.voxels[static_cast<std::size_t>(v)] = tag(Region::liver);
    chest.ct.voxels[static_cast<std::size_t>(v)] = 110;
    chest.tree[0].above.voxels[static_cast<std::size_t>(v)] = 1;
  }
  truth = chest.truth;
  return anatomy::segment_body(chest.ct, chest.tree, chest.chambers, {}, {}).liver;
}

TEST(Body, TheLiverIsFoundUnderTheRightLungOnly) {
  LabelVolume truth;
  const Mask right = liver_under_lung(-1, truth);
  EXPECT_GT(overlap(right, truth, Region::liver), 0.9);
  EXPECT_EQ(image::count(liver_under_lung(1, truth)), 0);
}

TEST(Trachea, IsFoundWithAndWithoutASeedAndDoesNotLeak) {
  const ToyChest chest = toy_chest();
  Landmarks landmarks;
  const Mask found = anatomy::segment_trachea(chest.ct, chest.tree, landmarks);
  EXPECT_GT(overlap(found, chest.truth, Region::trachea), 0.9);
  landmarks.seeds_mm["trachea"] = {1, 4, 30};
  EXPECT_EQ(anatomy::segment_trachea(chest.ct, chest.tree, landmarks).voxels, found.voxels);
  landmarks.seeds_mm["trachea"] = {1, -50, 0};
  EXPECT_THROW(anatomy::segment_trachea(chest.ct, chest.tree, landmarks), UserError);
}

TEST(Trachea, IsNotTheGasBelowTheHeart) {
  ToyChest chest = toy_chest();
  Landmarks landmarks;
  const Mask without_gas = anatomy::segment_trachea(chest.ct, chest.tree, landmarks);
  std::size_t v = 0;  // a longer chain of round air than the trachea's
  for (std::int64_t k = 0; k < chest.ct.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < chest.ct.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < chest.ct.grid.size[0]; ++i, ++v) {
        const Vec3 p =
            lps_from_index(chest.ct.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        if (p.z < 5 && std::hypot(p.x, p.y + 40) < 7) chest.ct.voxels[v] = -1000;
      }
  EXPECT_NE(anatomy::segment_trachea(chest.ct, chest.tree, landmarks).voxels, without_gas.voxels);
  landmarks.seeds_mm["lv_blood"] = {20, -20, 4};
  EXPECT_EQ(anatomy::segment_trachea(chest.ct, chest.tree, landmarks).voxels, without_gas.voxels);
}

TEST(Vessel, IsCutHalfWayAndALeakIsRefused) {
  Grid grid;
  grid.size = {40, 40, 40};
  grid.spacing_mm = {0.5, 0.5, 0.5};
  CtVolume angiogram(grid, 50);
  std::int64_t truth = 0;
  for (std::int64_t k = 0; k < 40; ++k)
    for (std::int64_t j = 0; j < 40; ++j)
      for (std::int64_t i = 0; i < 40; ++i) {
        const bool lumen = std::hypot(static_cast<double>(i) - 20, static_cast<double>(j) - 18) < 6;
        truth += lumen;
        const int noise = static_cast<int>((i * 7 + j * 13 + k * 29) % 41) - 20;
        angiogram(i, j, k) = static_cast<std::int16_t>((lumen ? 350 : 50) + noise);
      }
  const Vec3 seed = lps_from_index(grid, {20, 18, 20});
  const auto found = image::count(anatomy::segment_vessel(angiogram, seed));
  EXPECT_NEAR(static_cast<double>(found), static_cast<double>(truth), 0.03 * static_cast<double>(truth));
  EXPECT_THROW(anatomy::segment_vessel(angiogram, lps_from_index(grid, {3, 3, 20})), UserError);
  EXPECT_THROW(anatomy::segment_vessel(angiogram, {500, 0, 0}), UserError);
  EXPECT_THROW(anatomy::segment_vessel(angiogram, seed, {.maximum_volume_ml = 0.2}), UserError);
}

TEST(FuseLabels, PrecedenceAndIslands) {
  Grid grid;
  grid.size = {30, 20, 20};
  anatomy::BodyResult body{Mask(grid, 1), Mask(grid), Mask(grid), Mask(grid)};
  LabelVolume chambers(grid), walls(grid);
  Mask trachea(grid);
  for (std::int64_t k = 5; k < 15; ++k)
    for (std::int64_t j = 5; j < 15; ++j)
      for (std::int64_t i = 5; i < 15; ++i) {
        walls(i, j, k) = tag(Region::lv_myocardium);
        body.bone(i, j, k) = 1;
        if (i > 8) chambers(i, j, k) = tag(Region::lv_blood);
      }
  for (std::int64_t i = 20; i < 28; ++i) body.lung(i, 10, 10) = trachea(i, 10, 10) = body.bone(i, 10, 10) = 1;
  walls(18, 2, 2) = tag(Region::lv_myocardium);  // an island in the torso
  chambers(6, 10, 10) = tag(Region::lv_blood);   // an island in the wall
  const auto labels = anatomy::fuse_labels(chambers, walls, anatomy::label_surroundings(body, trachea));
  EXPECT_EQ(labels(10, 10, 10), tag(Region::lv_blood));
  EXPECT_EQ(labels(6, 7, 7), tag(Region::lv_myocardium));
  EXPECT_EQ(labels(22, 10, 10), tag(Region::trachea));
  EXPECT_EQ(labels(18, 2, 2), tag(Region::torso));
  EXPECT_EQ(labels(6, 10, 10), tag(Region::lv_myocardium));
  EXPECT_EQ(labels(0, 0, 0), tag(Region::torso));
}

}  // namespace
}  // namespace heartgen::anatomy
