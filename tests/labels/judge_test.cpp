// SPDX-License-Identifier: GPL-3.0-or-later
// Given labels that cannot be a heart.
#include "generator/labels/judge.hpp"

#include <gtest/gtest.h>

#include <map>

#include "generator/labels/given_labels.hpp"
#include "labels/toy_heart.hpp"
#include "model/error.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace heartgen::labels {
namespace {

using testing::fill;
using testing::toy_heart;
using enum Region;

/// The toy heart in another program's numbers.
std::string written_as(const std::map<Region, int>& numbers) {
  const auto toy = toy_heart();
  Volume<std::int16_t> image(toy.grid);
  for (std::size_t v = 0; v < toy.voxels.size(); ++v)
    if (const auto at = numbers.find(static_cast<Region>(toy.voxels[v])); at != numbers.end())
      image.voxels[v] = static_cast<std::int16_t>(at->second);
  const auto path = testing::scratch_folder("judged_labels") / "seg.nii.gz";
  adapters::write_volume(path.string(), image);
  return path.string();
}

const std::map<Region, int> heartchambers = {
    {lv_myocardium, 1}, {la_blood, 2}, {lv_blood, 3}, {ra_blood, 4}, {rv_blood, 5}};
const std::map<Region, int> version_1 = {
    {lv_myocardium, 44}, {la_blood, 45}, {lv_blood, 46}, {ra_blood, 47}, {rv_blood, 48}};
const std::map<Region, int> mm_whs = {
    {lv_myocardium, 205}, {la_blood, 420}, {lv_blood, 500}, {ra_blood, 550}, {rv_blood, 600}};

std::string refusal(const std::map<Region, int>& numbers, const std::string& preset) {
  InputSettings input;
  input.labels = written_as(numbers);
  LabelSettings settings;
  settings.preset = preset;
  return testing::error_of([&] { read_given_labels(input, settings, nullptr); });
}

TEST(AnotherTask, IsRefusedWithThePresetThatFits) {
  EXPECT_NE(refusal(heartchambers, "totalsegmentator").find("--preset totalsegmentator_heart"), std::string::npos);
  EXPECT_NE(refusal(heartchambers, "heartgen").find("--preset totalsegmentator_heart"), std::string::npos);
  EXPECT_NE(refusal(version_1, "totalsegmentator").find("--preset totalsegmentator_v1"), std::string::npos);
  EXPECT_NE(refusal(mm_whs, "heartgen").find("--preset mm_whs"), std::string::npos);
  EXPECT_EQ(refusal(heartchambers, "totalsegmentator_heart"), "");
  EXPECT_EQ(refusal(version_1, "totalsegmentator_v1"), "");
  EXPECT_EQ(refusal(mm_whs, "mm_whs"), "");
}

TEST(AnotherTask, IsNoMapWithoutAHeart) {
  EXPECT_EQ(refusal({{lv_myocardium, 5}, {rv_blood, 1}}, "totalsegmentator"), "") << "a liver and a spleen";
}

TEST(AnotherTask, IsTheUsersWordWhereThatIsGiven) {
  InputSettings input;
  input.labels = written_as(heartchambers);
  LabelSettings settings;
  settings.preset = "totalsegmentator";
  settings.ignore.keys = {"1", "2", "3", "4"};
  EXPECT_NO_THROW(read_given_labels(input, settings, nullptr));
}

TEST(NoHeart, HasChambersThatDoNotBelongTogether) {
  EXPECT_TRUE(looks_like_heart(toy_heart()));
  EXPECT_NO_THROW(refuse_no_heart(toy_heart(), "seg.nii.gz"));
  auto small = toy_heart();
  fill(small, [](const Vec3& p, std::uint8_t before) {
    return before == tag(rv_blood) && norm(p - Vec3{-14, 0, -16}) > 9 ? tag(none) : before;
  });
  EXPECT_FALSE(looks_like_heart(small));
  const auto message = testing::error_of([&] { refuse_no_heart(small, "seg.nii.gz"); });
  EXPECT_NE(message.find("rv_blood holds 2.9 ml beside lv_blood"), std::string::npos) << message;
  EXPECT_NO_THROW(refuse_no_heart(LabelVolume(small.grid), "seg.nii.gz")) << "no heart at all";
}

TEST(OrgansInTheHeart, AreRefused) {
  const auto found = toy_heart();
  auto given = LabelVolume(found.grid);
  for (std::size_t v = 0; v < given.voxels.size(); ++v)
    if (found.voxels[v] == tag(rv_blood)) given.voxels[v] = tag(liver);
  auto message = testing::error_of([&] { refuse_organs_in_heart(given, found, "seg.nii.gz"); });
  EXPECT_NE(message.find("100 % of the given liver"), std::string::npos) << message;
  for (std::size_t v = 0; v < given.voxels.size(); ++v)
    given.voxels[v] = found.voxels[v] == tag(lv_myocardium) ? tag(bone) : 0;
  message = testing::error_of([&] { refuse_organs_in_heart(given, found, "seg.nii.gz"); });
  EXPECT_NE(message.find("bone"), std::string::npos) << message;
}

TEST(OrgansInTheHeart, MayLieAroundIt) {
  const auto found = toy_heart();
  auto given = LabelVolume(found.grid);
  fill(given, [&](const Vec3& p, std::uint8_t) {
    const bool is_free = testing::toy_region(p) == none;
    return is_free ? tag(p.x > 0 ? lung : p.z < -20 ? liver : none) : tag(none);
  });
  EXPECT_NO_THROW(refuse_organs_in_heart(given, found, "seg.nii.gz"));
}

TEST(LabelsBesideTheHeart, AreRefusedWhereTheWallIsAsBrightAsBlood) {
  const auto labels = toy_heart();
  auto ct = testing::toy_ct(labels);
  EXPECT_NO_THROW(refuse_labels_beside_heart(labels, ct, "seg.nii.gz"));
  fill(ct, [](const Vec3& p, std::int16_t) {
    return is_blood(testing::toy_region(p - Vec3{20, 0, 0})) ? 350 : 110;  // another place than the labels say
  });
  const auto message = testing::error_of([&] { refuse_labels_beside_heart(labels, ct, "seg.nii.gz"); });
  EXPECT_NE(message.find("as bright as blood"), std::string::npos) << message;
}

}  // namespace
}  // namespace heartgen::labels
