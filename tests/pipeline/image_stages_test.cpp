// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/image_stages.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "model/labels.hpp"

namespace heartgen {
namespace {

const Warning* with_code(const std::vector<Warning>& warnings, const std::string& code) {
  const auto found = std::ranges::find(warnings, code, &Warning::code);
  return found == warnings.end() ? nullptr : &*found;
}

struct LabelWarnings : ::testing::Test {
  LabelVolume given;
  void SetUp() override {
    Grid grid;
    grid.size = {10, 10, 10};
    given = LabelVolume(grid);
    std::fill_n(given.voxels.begin(), 200, tag(Region::lv_blood));
  }
};

TEST_F(LabelWarnings, WhatAGivenRegionGainedIsTold) {
  LabelVolume heart = given;
  std::fill_n(heart.voxels.begin() + 200, 100, tag(Region::lv_blood));
  std::fill_n(heart.voxels.begin() + 300, 50, tag(Region::lv_myocardium));
  const auto warnings = pipeline::label_notes(given, heart, true);
  const auto* grown = with_code(warnings, "labels.grown");
  ASSERT_NE(grown, nullptr);
  EXPECT_NE(grown->text.find("lv_blood by 0.1 ml"), std::string::npos) << grown->text;
  EXPECT_EQ(grown->text.find("lv_myocardium"), std::string::npos) << "it was not given: it is made, not grown";
  const auto* completed = with_code(warnings, "labels.completed");
  ASSERT_NE(completed, nullptr);
  EXPECT_NE(completed->text.find("lv_myocardium"), std::string::npos) << completed->text;
}

TEST_F(LabelWarnings, NothingGrewWhereNothingChanged) {
  EXPECT_EQ(with_code(pipeline::label_notes(given, given, true), "labels.grown"), nullptr);
}

TEST_F(LabelWarnings, AVentricleWithoutAnOutletIsTold) {
  const auto* missing = with_code(pipeline::label_notes(given, given, true), "labels.no_outlet");
  ASSERT_NE(missing, nullptr);
  EXPECT_EQ(missing->level, WarningLevel::warning);
}

}  // namespace
}  // namespace heartgen
