// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/epicardium.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "anatomy/toy_heart.hpp"
#include "generator/anatomy/chambers.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "support/places.hpp"

namespace heartgen::anatomy {
namespace {

/// The blood of a label map.
LabelVolume heart_blood(const LabelVolume& truth) {
  LabelVolume blood = truth;
  for (auto& label : blood.voxels)
    if (!is_blood(static_cast<Region>(label))) label = 0;
  return blood;
}

LabelVolume chambers_of(const ToyHeart& heart) {
  return anatomy::split_chambers(heart.ct, heart.tree, heart.landmarks, {});
}

TEST(Epicardium, WallsAreFoundAndLeaveBloodAlone) {
  const ToyHeart heart = toy_heart();
  const auto chambers = chambers_of(heart);
  const auto result = anatomy::epicardium(heart.ct, chambers, {}, parallel::self());
  EXPECT_GT(dice(result.walls, heart.truth, Region::lv_myocardium), 0.93);
  EXPECT_GT(dice(result.walls, heart.truth, Region::rv_myocardium), 0.75);
  EXPECT_GT(dice(result.walls, heart.truth, Region::la_wall), 0.6);
  EXPECT_GT(dice(result.walls, heart.truth, Region::ra_wall), 0.6);
  EXPECT_LE(result.ventricle_duality_gap, 1e-3);
  for (std::size_t v = 0; v < chambers.voxels.size(); ++v)
    if (chambers.voxels[v]) {
      EXPECT_EQ(result.walls.voxels[v], 0);
    }
}

TEST(Epicardium, AFoldOfTheRightFreeWallIsNotTheLeftWall) {
  const ToyHeart heart = toy_heart();
  LabelVolume chambers = heart_blood(heart.truth);
  const auto place = [&](std::size_t voxel) {
    return testing::lps_of_voxel(chambers.grid, static_cast<std::int64_t>(voxel));
  };
  for (std::size_t v = 0; v < chambers.voxels.size(); ++v) {  // muscle that stands in the right cavity
    const Vec3 p = place(v);
    if (p.x > -31 && p.x < -26 && p.y > 0 && chambers.voxels[v] == tag(Region::rv_blood)) chambers.voxels[v] = 0;
  }
  const auto result = anatomy::epicardium(heart.ct, chambers, {}, parallel::self());
  std::int64_t left = 0;
  for (std::size_t v = 0; v < chambers.voxels.size(); ++v)
    left += result.walls.voxels[v] == tag(Region::lv_myocardium) && place(v).x < -20;
  EXPECT_EQ(left, 0);
}

/// Signed distance (mm) from the middle of a face to the toy's outer surfaces, negative inside.
double outside_distance(const Vec3& p) {
  return std::min(
      {norm(p - toy::lv) - 24, norm(p - toy::rv) - 18.5, norm(p - toy::la) - 17.5, norm(p - toy::ra) - 16.5});
}

/// Mean signed distance of the walls' outer faces to the toy's surface, away from where chambers meet.
double outer_bias_mm(const LabelVolume& walls) {
  const Grid& grid = walls.grid;
  double sum = 0;
  std::int64_t faces = 0;
  for (std::int64_t k = 1; k + 1 < grid.size[2]; ++k)
    for (std::int64_t j = 1; j + 1 < grid.size[1]; ++j)
      for (std::int64_t i = 1; i + 1 < grid.size[0]; ++i) {
        if (!walls(i, j, k)) continue;
        for (const Index3& step : {Index3{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
          const auto at = [&](double share) {
            return lps_from_index(grid, {static_cast<double>(i) + share * static_cast<double>(step[0]),
                                         static_cast<double>(j) + share * static_cast<double>(step[1]),
                                         static_cast<double>(k) + share * static_cast<double>(step[2])});
          };
          const bool clear = std::abs(at(0).x) > 25 && std::abs(at(0).z - 7) > 8;
          if (walls(i + step[0], j + step[1], k + step[2]) || !clear || toy::region_at(at(1)) != Region::none) continue;
          sum += outside_distance(at(0.5));
          ++faces;
        }
      }
  EXPECT_GT(faces, 2000);
  return sum / static_cast<double>(faces);
}

TEST(Epicardium, WallsEndAtHalfHeightWhateverTheNoise) {
  for (const double noise : {0.0, 15.0, 40.0}) {
    const ToyHeart heart = toy_heart({.noise_hu = noise});
    const auto walls = anatomy::epicardium(heart.ct, heart_blood(heart.truth), {}, parallel::self()).walls;
    EXPECT_NEAR(outer_bias_mm(walls), 0, 0.3) << noise;  // a fifth of a voxel
    EXPECT_GT(dice(walls, heart.truth, Region::rv_myocardium), 0.88) << noise;
    EXPECT_GT(dice(walls, heart.truth, Region::lv_myocardium), 0.95) << noise;
  }
}

/// Fills the space below `z_mm` outside the heart with tissue as bright as muscle.
void add_liver(ToyHeart& heart, double z_mm) {
  std::size_t v = 0;
  for (std::int64_t k = 0; k < heart.ct.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < heart.ct.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < heart.ct.grid.size[0]; ++i, ++v) {
        const double z = lps_from_index(heart.ct.grid, {0, 0, static_cast<double>(k)}).z;
        if (z < z_mm && heart.truth.voxels[v] == tag(Region::none)) heart.ct.voxels[v] = 110;
      }
}

std::int64_t walls_outside(const LabelVolume& walls, const LabelVolume& truth) {
  std::int64_t outside = 0;
  for (std::size_t v = 0; v < walls.voxels.size(); ++v) outside += walls.voxels[v] && !truth.voxels[v];
  return outside;
}

TEST(Epicardium, ThinFatKeepsTheLiverOut) {
  ToyHeart heart = toy_heart();
  const LabelVolume blood = heart_blood(heart.truth);
  const auto free = walls_outside(anatomy::epicardium(heart.ct, blood, {}, parallel::self()).walls, heart.truth);
  add_liver(heart, -38);  // 4 mm below the left ventricle's wall, 9.5 mm below the right one's
  const auto near = walls_outside(anatomy::epicardium(heart.ct, blood, {}, parallel::self()).walls, heart.truth);
  EXPECT_LT(near, free + 200);
}

TEST(Epicardium, ContactWithTissueAsBrightAsMuscleIsCutShort) {
  ToyHeart heart = toy_heart();
  add_liver(heart, -24);  // the lower third of both walls lies in it
  const auto walls = anatomy::epicardium(heart.ct, heart_blood(heart.truth), {}, parallel::self()).walls;
  EXPECT_GT(dice(walls, heart.truth, Region::lv_myocardium), 0.85);
  EXPECT_GT(dice(walls, heart.truth, Region::rv_myocardium), 0.7);
}

TEST(Epicardium, KnownWallsAreKeptAndNotCutAgain) {
  const ToyHeart heart = toy_heart();
  const LabelVolume blood = heart_blood(heart.truth);
  LabelVolume known(heart.truth.grid);
  for (std::size_t v = 0; v < known.voxels.size(); ++v)
    if (heart.truth.voxels[v] == tag(Region::lv_myocardium)) known.voxels[v] = heart.truth.voxels[v];
  const auto left = anatomy::epicardium(heart.ct, blood, {}, parallel::self(), known);
  EXPECT_EQ(dice(left.walls, heart.truth, Region::lv_myocardium), 1);
  EXPECT_GT(dice(left.walls, heart.truth, Region::rv_myocardium), 0.85);
  for (std::size_t v = 0; v < known.voxels.size(); ++v)
    if (is_myocardium(static_cast<Region>(heart.truth.voxels[v]))) known.voxels[v] = heart.truth.voxels[v];
  const auto all = anatomy::epicardium(heart.ct, blood, {}, parallel::self(), known);
  EXPECT_EQ(all.walls.voxels, known.voxels);
  EXPECT_EQ(all.ventricle_iterations + all.atrium_iterations, 0);
}

TEST(Epicardium, SameBitsForAnyNumberOfThreads) {
  const ToyHeart heart = toy_heart();
  const int threads = parallel::thread_count();
  parallel::set_thread_count(1);
  const auto one = anatomy::epicardium(heart.ct, heart_blood(heart.truth), {}, parallel::self());
  parallel::set_thread_count(3);
  const auto three = anatomy::epicardium(heart.ct, heart_blood(heart.truth), {}, parallel::self());
  parallel::set_thread_count(threads);
  EXPECT_EQ(one.walls.voxels, three.walls.voxels);
  EXPECT_EQ(one.ventricle_duality_gap, three.ventricle_duality_gap);
}

/// Voxels outside the heart that share a face or an edge with a chamber's blood.
std::int64_t pinholes(const LabelVolume& chambers, const LabelVolume& walls) {
  std::int64_t bare = 0;
  const auto& size = chambers.grid.size;
  for (std::int64_t k = 1; k + 1 < size[2]; ++k)
    for (std::int64_t j = 1; j + 1 < size[1]; ++j)
      for (std::int64_t i = 1; i + 1 < size[0]; ++i) {
        const auto region = static_cast<Region>(chambers(i, j, k));
        if (!is_blood(region) || region == Region::aorta) continue;
        for (std::int64_t n = 0; n < 27; ++n) {
          if (n % 3 != 1 && n / 3 % 3 != 1 && n / 9 != 1) continue;  // corners
          const std::int64_t x = i + n % 3 - 1, y = j + n / 3 % 3 - 1, z = k + n / 9 - 1;
          bare += chambers(x, y, z) == 0 && walls(x, y, z) == 0;
        }
      }
  return bare;
}

TEST(Epicardium, WallsHaveNoPinholes) {
  const ToyHeart heart = toy_heart();
  const auto chambers = chambers_of(heart);
  EpicardiumSettings thin;  // thinner than a voxel is wide
  thin.minimum_lv_wall_mm = thin.minimum_rv_wall_mm = thin.minimum_atrial_wall_mm = 0.5;
  EXPECT_EQ(pinholes(chambers, anatomy::epicardium(heart.ct, chambers, {}, parallel::self()).walls), 0);
  EXPECT_EQ(pinholes(chambers, anatomy::epicardium(heart.ct, chambers, thin, parallel::self()).walls), 0);
}

/// Two ventricles that share a septum: the left one a ball with a wall of 10 mm, the right one a crescent around it.
Region ventricles_at(const Vec3& p) {
  const double left = norm(p - Vec3{10, 0, 0}), right = norm((p - Vec3{-14, 0, 0}));
  if (left < 16) return Region::lv_blood;
  if (left < 26) return Region::lv_myocardium;
  if (norm(p - Vec3{10, 0, 42}) < 12) return Region::la_blood;
  if (norm(p - Vec3{-20, 0, 46}) < 12) return Region::ra_blood;
  if (right < 24) return Region::rv_blood;
  return right < 28 ? Region::rv_myocardium : Region::none;
}

TEST(Epicardium, RightFreeWallMeetsTheLeftWallWhereThatGoesOn) {
  Grid grid;
  grid.size = {96, 76, 70};
  grid.spacing_mm = {1.2, 1.2, 1.8};
  grid.origin_mm = {-60, -45, -50};
  CtVolume ct(grid);
  LabelVolume truth(grid), blood(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const Region region = ventricles_at(
            lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
        truth(i, j, k) = tag(region);
        blood(i, j, k) = is_blood(region) ? tag(region) : std::uint8_t{0};
        ct(i, j, k) = region == Region::none ? std::int16_t{-90}
                      : is_blood(region)     ? std::int16_t{350}
                                             : std::int16_t{110};
      }
  const auto walls = anatomy::epicardium(ct, blood, {}, parallel::self()).walls;
  std::int64_t right = 0, called_left = 0;
  for (std::size_t v = 0; v < walls.voxels.size(); ++v) {
    if (truth.voxels[v] != tag(Region::rv_myocardium)) continue;
    ++right;
    called_left += walls.voxels[v] == tag(Region::lv_myocardium);
  }
  EXPECT_LT(static_cast<double>(called_left), 0.02 * static_cast<double>(right));
  EXPECT_GT(dice(walls, truth, Region::rv_myocardium), 0.93);
  EXPECT_GT(dice(walls, truth, Region::lv_myocardium), 0.95);
}

TEST(Epicardium, EmptyChambersAreAUserError) {
  const ToyHeart heart = toy_heart();
  EXPECT_THROW(anatomy::epicardium(heart.ct, LabelVolume(heart.ct.grid), {}, parallel::self()), UserError);
}

}  // namespace
}  // namespace heartgen::anatomy
