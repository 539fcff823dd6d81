// SPDX-License-Identifier: GPL-3.0-or-later
// Islands, crumbs and gaps of label maps, and valves that are closed.
#include <gtest/gtest.h>

#include "generator/labels/gaps.hpp"
#include "generator/labels/islands.hpp"
#include "labels/toy_heart.hpp"

namespace heartgen::labels {
namespace {

using testing::fill;
using testing::toy_heart;
using testing::voxels_of;
using enum Region;

void put_ball(LabelVolume& labels, const Vec3& centre, double radius_mm, Region region) {
  fill(labels, [&](const Vec3& p, std::uint8_t before) { return norm(p - centre) < radius_mm ? tag(region) : before; });
}

TEST(Islands, AreDroppedAndTold) {
  auto labels = toy_heart();
  const auto clean = labels;
  put_ball(labels, {-70, 0, 40}, 4.5, lv_myocardium);
  put_ball(labels, {71, 20, -40}, 5, la_blood);
  const auto lost = voxels_of(labels, lv_myocardium) - voxels_of(clean, lv_myocardium);
  const auto warnings = drop_islands(labels);
  EXPECT_EQ(labels.voxels, clean.voxels);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0].code, "labels.islands");
  EXPECT_EQ(warnings[0].level, WarningLevel::warning);
  EXPECT_NE(warnings[0].text.find("lv_myocardium, " + std::to_string(lost) + " voxels"), std::string::npos)
      << warnings[0].text;
  EXPECT_NE(warnings[1].text.find("la_blood"), std::string::npos);
}

TEST(Islands, AreNoPartsOfAHeart) {
  auto labels = toy_heart();
  put_ball(labels, {72, 25, 0}, 7, aorta);                // the ascending aorta is what touches nothing here
  put_ball(labels, {-70, 25, 0}, 6.5, aorta);             // 1.1 ml: the descending one
  put_ball(labels, {-70, -25, 30}, 7, pulmonary_artery);  // the only piece of its region
  const auto before = labels;
  EXPECT_TRUE(drop_islands(labels).empty());
  EXPECT_EQ(labels.voxels, before.voxels);
  put_ball(labels, {0, -33, 40}, 4, aorta);
  EXPECT_EQ(drop_islands(labels).size(), 1U) << "less than 1 ml";
  EXPECT_EQ(labels.voxels, before.voxels);
}

TEST(Crumbs, GoToWhatIsAroundThem) {
  auto labels = toy_heart();
  const auto clean = labels;
  put_ball(labels, {31, 1, -11}, 1, papillary);
  put_ball(labels, {21, 1, -21}, 2.5, papillary);
  put_ball(labels, {55, 1, -17}, 1, rv_blood);
  EXPECT_GT(absorb_crumbs(labels, crumb_mm3(4)), 0);
  EXPECT_EQ(labels.voxels, clean.voxels);
  put_ball(labels, {31, 1, -11}, 6, papillary);
  const auto before = labels;
  EXPECT_EQ(absorb_crumbs(labels, crumb_mm3(4)), 0) << "905 mm3 are a papillary muscle";
  EXPECT_EQ(labels.voxels, before.voxels);
}

/// The toy with an atrium that ends a voxel or more above the valve's plane.
LabelVolume with_gap(double mm) {
  auto labels = toy_heart();
  fill(labels,
       [&](const Vec3& p, std::uint8_t before) { return before == tag(ra_blood) && p.z < mm ? tag(none) : before; });
  return labels;
}

/// Voxels of the right heart's blood in the toy's gap.
std::int64_t in_gap(const LabelVolume& labels, double mm) {
  const auto truth = toy_heart(), gap = with_gap(mm);
  std::int64_t count = 0;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    count += truth.voxels[v] == tag(ra_blood) && gap.voxels[v] == 0 &&
             (labels.voxels[v] == tag(ra_blood) || labels.voxels[v] == tag(rv_blood));
  return count;
}

TEST(Gaps, AreClosedByTheNearestChamberWhereTheCtShowsBlood) {
  const auto truth = toy_heart();
  const auto ct = testing::toy_ct(truth);
  for (const double mm : {2.0, 4.0}) {
    const auto given = with_gap(mm);
    ASSERT_EQ(closed_valves(given).size(), 3U) << "and neither great vessel is there";
    const auto closed = with_closed_gaps(given, given, &ct);
    EXPECT_EQ(closed_valves(closed).size(), 2U) << mm;
    EXPECT_EQ(voxels_of(closed, lv_blood), voxels_of(given, lv_blood));
    EXPECT_EQ(with_closed_gaps(truth, truth, &ct).voxels, truth.voxels) << "an open valve";
  }
  CtVolume leaflets = ct;  // muscle in the gap
  fill(leaflets, [](const Vec3& p, std::int16_t before) { return p.z > 0 && p.z < 2 ? 110 : before; });
  const auto given = with_gap(2);
  EXPECT_EQ(with_closed_gaps(given, given, &leaflets).voxels, given.voxels);
}

TEST(Gaps, AreClosedWithoutACtAsWell) {
  const auto given = with_gap(4);
  const auto closed = with_closed_gaps(given, given, nullptr);
  EXPECT_GT(in_gap(closed, 4), 40);
  EXPECT_EQ(closed_valves(closed).size(), 2U);
  const auto wide = with_gap(10);
  EXPECT_EQ(with_closed_gaps(wide, wide, nullptr).voxels, wide.voxels) << "no gap: the chambers are apart";
}

TEST(Gaps, LeaveWhatIsGiven) {
  auto given = with_gap(2);
  fill(given, [](const Vec3& p, std::uint8_t before) {
    return before == 0 && p.z > 0 && p.z < 2 ? tag(rv_myocardium) : before;
  });
  auto chambers = with_gap(2);
  EXPECT_EQ(with_closed_gaps(chambers, given, nullptr).voxels, chambers.voxels);
  EXPECT_EQ(with_closed_gaps(chambers, {}, nullptr).voxels, chambers.voxels) << "nothing is given";
}

TEST(ClosedValves, NameTheOrificeAndWhatIsMissing) {
  const auto warnings = closed_valves(toy_heart());
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0].code, "labels.no_outlet");
  EXPECT_EQ(warnings[0].text, "aortic_orifice is missing: without aorta, lv_blood has no outlet.");
  EXPECT_EQ(warnings[1].text, "pulmonary_orifice is missing: without pulmonary_artery, rv_blood has no outlet.");
  EXPECT_NE(closed_valves(with_gap(2))[1].text.find("ra_blood and rv_blood do not touch"), std::string::npos);
}

}  // namespace
}  // namespace heartgen::labels
