// SPDX-License-Identifier: GPL-3.0-or-later
// The limits of confidence, and what is given by hand beside what was found.
#include "generator/landmarks/judge.hpp"

#include <gtest/gtest.h>

#include "generator/landmarks/left_wall.hpp"

namespace heartgen::landmarks {
namespace {

FoundLandmarks all_found() {
  FoundLandmarks found;
  for (const char* pool : {"lv_blood", "rv_blood", "la_blood", "ra_blood", "aorta", "pulmonary_artery"})
    found.landmarks.seeds_mm[pool] = {};
  for (const char* valve : {"mitral", "aortic", "tricuspid", "pulmonary"}) found.landmarks.valves[valve] = {};
  found.confidence = 1;
  return found;
}

TEST(Trust, HasTwoLimits) {
  EXPECT_EQ(trust_in(1), Trust::sound);
  EXPECT_EQ(trust_in(min_sound_confidence), Trust::sound);
  EXPECT_EQ(trust_in(min_sound_confidence - 0.01), Trust::uncertain);
  EXPECT_EQ(trust_in(min_confidence - 0.01), Trust::doubtful);
}

TEST(Trust, IsLostWithOneMissingPoolOrValve) {
  EXPECT_EQ(trust_in(missing_keeps), Trust::doubtful);
  EXPECT_EQ(trust_in(missing_half_keeps), Trust::doubtful);
}

TEST(Trust, ComesBackWithWhatIsGivenByHand) {
  auto found = all_found();
  found.landmarks.seeds_mm.erase("pulmonary_artery");
  found.landmarks.valves.erase("pulmonary");
  found.confidence = missing_keeps * missing_keeps;
  Landmarks given;
  EXPECT_DOUBLE_EQ(confidence_beside(found, given), missing_keeps * missing_keeps);
  given.seeds_mm["pulmonary_artery"] = {1, 2, 3};
  EXPECT_NEAR(confidence_beside(found, given), missing_keeps, 1e-12);
  given.valves["pulmonary"] = {};
  EXPECT_NEAR(confidence_beside(found, given), 1, 1e-12);
  given.valves["mitral"] = {};  // was found as well
  EXPECT_NEAR(confidence_beside(found, given), 1, 1e-12);
}

TEST(Trust, InAMissingRightHeartNeedsAllOfIt) {
  auto found = all_found();
  for (const char* pool : {"rv_blood", "ra_blood", "pulmonary_artery"}) found.landmarks.seeds_mm.erase(pool);
  for (const char* valve : {"tricuspid", "pulmonary"}) found.landmarks.valves.erase(valve);
  found.confidence = missing_half_keeps;
  Landmarks given;
  given.seeds_mm = {{"rv_blood", {}}, {"ra_blood", {}}, {"pulmonary_artery", {}}};
  given.valves["tricuspid"] = {};
  EXPECT_DOUBLE_EQ(confidence_beside(found, given), missing_half_keeps);
  given.valves["pulmonary"] = {};
  EXPECT_DOUBLE_EQ(confidence_beside(found, given), 1);
}

/// A ball of 150 HU with a shell around it, in lung.
LeftWall wall_of(float shell_hu) {
  Grid grid;
  grid.size = {60, 60, 60};
  LabelVolume chambers(grid);
  Volume<float> smooth(grid, -800);
  for (std::int64_t k = 0; k < 60; ++k)
    for (std::int64_t j = 0; j < 60; ++j)
      for (std::int64_t i = 0; i < 60; ++i) {
        const double r = norm(Vec3{i - 30.0, j - 30.0, k - 30.0});
        if (r < 15) chambers(i, j, k) = tag(Region::lv_blood);
        if (r < 24) smooth(i, j, k) = r < 15 ? 150 : shell_hu;
      }
  return look_at_left_wall(chambers, smooth);
}

TEST(LeftWall, IsMuscleOfAVentricleAndBoneOfAVertebra) {
  EXPECT_DOUBLE_EQ(wall_of(110).muscle, 1);
  EXPECT_DOUBLE_EQ(wall_of(110).bone, 0);
  EXPECT_DOUBLE_EQ(wall_of(400).muscle, 0);
  EXPECT_DOUBLE_EQ(wall_of(400).bone, 1);
}

}  // namespace
}  // namespace heartgen::landmarks
