// SPDX-License-Identifier: GPL-3.0-or-later
// The phantom's heart is an adult human heart, the right way round, and its pools are tight.
#include "datasets/phantom/anatomy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "datasets/survey.hpp"
#include "model/error.hpp"

namespace heartgen::phantom {
namespace {

/// One survey of the default patient, shared by the tests of this file.
const Survey& default_survey() {
  static const Survey survey = survey_heart(make_heart_model(), 1.5);
  return survey;
}

Vec3 centroid(const LabelVolume& labels, Region region) {
  Vec3 sum;
  double count = 0;
  const Grid& grid = labels.grid;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        if (labels(i, j, k) == tag(region)) {
          sum += lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          ++count;
        }
  return sum / count;
}

TEST(Anatomy, VolumesAreHuman) {
  const auto& labels = default_survey().regions;
  const std::map<Region, std::pair<double, double>> range_ml = {
      {Region::lv_blood, {90, 170}}, {Region::rv_blood, {100, 200}},      {Region::la_blood, {50, 110}},
      {Region::ra_blood, {60, 120}}, {Region::lv_myocardium, {100, 180}}, {Region::rv_myocardium, {35, 80}},
      {Region::papillary, {3, 12}},  {Region::la_wall, {10, 35}},         {Region::ra_wall, {10, 35}}};
  for (const auto& [region, range] : range_ml) {
    EXPECT_GT(volume_ml(labels, region), range.first) << region_name(tag(region));
    EXPECT_LT(volume_ml(labels, region), range.second) << region_name(tag(region));
  }
}

TEST(Anatomy, EveryRegionIsOnePieceButForSpecks) {
  const auto& labels = default_survey().regions;
  for (auto region = tag(Region::lv_myocardium); region <= tag(Region::pulmonary_artery); ++region) {
    const auto pieces = component_volumes_ml(
        labels.grid, [&](std::int64_t offset) { return labels.voxels[static_cast<std::size_t>(offset)] == region; });
    // Two muscles in the left ventricle; in the right one the anterior muscle with its band, and the inferior one.
    const std::size_t expected = region == tag(Region::papillary) ? 4 : 1;
    ASSERT_GE(pieces.size(), expected) << region_name(region);
    EXPECT_GT(pieces[expected - 1], 0.3) << region_name(region);
    for (std::size_t n = expected; n < pieces.size(); ++n) EXPECT_LT(pieces[n], 0.03) << region_name(region);
  }
}

TEST(Anatomy, IsNotMirrored) {
  const auto& labels = default_survey().regions;
  const Vec3 lv = centroid(labels, Region::lv_blood), rv = centroid(labels, Region::rv_blood);
  const Vec3 la = centroid(labels, Region::la_blood), ra = centroid(labels, Region::ra_blood);
  EXPECT_LT(rv.x, lv.x - 15) << "the right ventricle lies to the right (smaller x in LPS)";
  EXPECT_LT(rv.y, lv.y - 10) << "and in front (smaller y)";
  EXPECT_GT(la.y, lv.y + 20) << "the left atrium lies behind";
  EXPECT_GT(la.y, ra.y + 20);
  EXPECT_LT(ra.x, la.x - 15) << "the right atrium lies on the right";
  const auto marks = landmarks_of(make_heart_model());
  const Vec3 pulmonary = marks.valves.at("pulmonary").center_mm, aortic = marks.valves.at("aortic").center_mm;
  EXPECT_GT(pulmonary.x, aortic.x + 8) << "pulmonary valve to the left of the aortic valve";
  EXPECT_LT(pulmonary.y, aortic.y - 10) << "in front of it";
  EXPECT_GT(pulmonary.z, aortic.z + 8) << "and above it";
  const Vec3 apex = *marks.lv_apex_mm, mitral = marks.valves.at("mitral").center_mm;
  EXPECT_GT(apex.x, mitral.x + 30) << "the apex points to the left,";
  EXPECT_LT(apex.y, mitral.y - 30) << "forwards";
  EXPECT_LT(apex.z, mitral.z - 20) << "and down";
  EXPECT_LT(marks.seeds_mm.at("liver").x, -30) << "the liver lies on the right";
}

TEST(Anatomy, PoolsTouchOnlyAtTheirValves) {
  const auto& survey = default_survey();
  const Grid& grid = survey.regions.grid;
  const auto marks = landmarks_of(make_heart_model());
  const auto name_of = [](Region a, Region b) -> std::string {
    using enum Region;
    const std::map<std::pair<Region, Region>, std::string> valves = {{{lv_blood, la_blood}, "mitral"},
                                                                     {{lv_blood, aorta}, "aortic"},
                                                                     {{rv_blood, ra_blood}, "tricuspid"},
                                                                     {{rv_blood, pulmonary_artery}, "pulmonary"}};
    const auto found = valves.find(std::minmax(a, b));
    return found == valves.end() ? "" : found->second;
  };
  std::map<std::string, double> area_mm2;
  for_each_contact(grid, [&](const auto& at, const auto& next) {
    const auto a = static_cast<Region>(survey.regions(at[0], at[1], at[2]));
    const auto b = static_cast<Region>(survey.regions(next[0], next[1], next[2]));
    if (a == b || !is_blood(a) || !is_blood(b)) return;
    const auto valve = name_of(a, b);
    const Vec3 p =
        lps_from_index(grid, {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])});
    ASSERT_NE(valve, "") << region_name(tag(a)) << " touches " << region_name(tag(b)) << " at " << p.x << " " << p.y
                         << " " << p.z;
    const auto& disc = marks.valves.at(valve);
    EXPECT_LT(std::abs(dot(p - disc.center_mm, disc.normal)), 2.2) << valve;
    EXPECT_LT(norm(p - disc.center_mm), disc.radius_mm + 2.5) << valve;
    const int axis = at[0] != next[0] ? 0 : at[1] != next[1] ? 1 : 2;
    // A staircase over a plane shows each axis its projected area: weighting by the normal gives the plane's area.
    area_mm2[valve] += std::abs(disc.normal[axis]) * grid.spacing_mm.x * grid.spacing_mm.x;
  });
  for (const auto& [name, disc] : marks.valves)
    EXPECT_NEAR(area_mm2[name] / (3.14159265 * disc.radius_mm * disc.radius_mm), 1, 0.25) << name;
}

TEST(Anatomy, BloodIsWalledOffFromFatLungAndAir) {
  const auto& survey = default_survey();
  std::map<std::string, int> leaks;
  for_each_contact(survey.regions.grid, [&](const auto& at, const auto& next) {
    for (const auto& [x, y] : {std::pair{at, next}, std::pair{next, at}}) {
      const auto region = static_cast<Region>(survey.regions(x[0], x[1], x[2]));
      const auto other = static_cast<Tissue>(survey.tissues(y[0], y[1], y[2]));
      if (is_blood(region) && (other == Tissue::fat || other == Tissue::lung || other == Tissue::air))
        ++leaks[region_name(tag(region))];
    }
  });
  for (const auto& [name, count] : leaks) ADD_FAILURE() << name << " touches fat, lung or air at " << count << " faces";
}

TEST(Anatomy, SeedsLieInTheirRegionsInEveryVariant) {
  for (int variant = 0; variant < 40; ++variant) {
    const auto model = make_heart_model(variant);
    const auto marks = landmarks_of(model);
    for (const auto& [name, seed] : marks.seeds_mm)
      EXPECT_EQ(region_name(tag(region_at(model, seed))), name) << "variant " << variant;
    for (const auto& [name, valve] : marks.valves) {
      const Vec3 step = 1.0 * valve.normal;
      const Region inside = region_at(model, valve.center_mm - step),
                   outside = region_at(model, valve.center_mm + step);
      EXPECT_EQ(inside, name == "mitral" || name == "aortic" ? Region::lv_blood : Region::rv_blood) << name << variant;
      EXPECT_TRUE(is_blood(outside) && outside != inside) << name << " in variant " << variant;
    }
    const Vec3 inwards = normalized(marks.valves.at("mitral").center_mm - *marks.lv_apex_mm);
    EXPECT_EQ(region_at(model, *marks.lv_apex_mm + inwards), Region::lv_myocardium) << variant;
    EXPECT_NE(region_at(model, *marks.lv_apex_mm - inwards), Region::lv_myocardium) << variant;
  }
}

TEST(Anatomy, VariantsDifferAndStayHuman) {
  const Vec3 first = long_axis(make_heart_model(0));
  for (const int variant : {1, 7}) {
    const auto model = make_heart_model(variant);
    EXPECT_LT(dot(long_axis(model), first), 0.9999);
    const auto labels = survey_heart(model, 2.5).regions;
    EXPECT_GT(volume_ml(labels, Region::lv_blood), 75);
    EXPECT_LT(volume_ml(labels, Region::lv_blood), 180);
    EXPECT_GT(volume_ml(labels, Region::rv_blood), 90);
    EXPECT_LT(volume_ml(labels, Region::rv_blood), 210);
    EXPECT_GT(volume_ml(labels, Region::la_blood), 45);
  }
}

TEST(Anatomy, WallOverridesTakeEffectAndAreChecked) {
  HeartOverrides thick;
  thick.lv_wall_mm = 15;
  const auto normal = survey_heart(make_heart_model(0), 3).regions,
             hypertrophic = survey_heart(make_heart_model(0, thick), 3).regions;
  EXPECT_GT(volume_ml(hypertrophic, Region::lv_myocardium), 1.4 * volume_ml(normal, Region::lv_myocardium));
  EXPECT_NEAR(volume_ml(hypertrophic, Region::lv_blood), volume_ml(normal, Region::lv_blood), 6);
  EXPECT_THROW(make_heart_model(-1), UserError);
  thick.lv_wall_mm = 40;
  EXPECT_THROW(make_heart_model(0, thick), UserError);
}

TEST(Anatomy, AHeartTurnsAndGrowsInTheChest) {
  HeartOverrides overrides;
  overrides.rotation_deg = {20, -20, 20};
  const auto turned = make_heart_model(0, overrides);
  const Vec3 axis = long_axis(make_heart_model(0));
  // x, then y, then z, by the right hand.
  const double s = std::sin(20 * std::numbers::pi / 180), c = std::cos(20 * std::numbers::pi / 180);
  const Vec3 x{axis.x, c * axis.y - s * axis.z, s * axis.y + c * axis.z};
  const Vec3 y{c * x.x - s * x.z, x.y, s * x.x + c * x.z};
  EXPECT_LT(norm(long_axis(turned) - Vec3{c * y.x - s * y.y, s * y.x + c * y.y, y.z}), 1e-12);

  overrides.scale = 1.2;
  const auto model = make_heart_model(0, overrides);
  for (const auto& [name, seed] : landmarks_of(model).seeds_mm)
    EXPECT_EQ(region_name(tag(region_at(model, seed))), name);
  const auto usual = survey_heart(make_heart_model(0), 2).regions, labels = survey_heart(turned, 2).regions,
             large = survey_heart(model, 2).regions;
  for (const Region region : {Region::lv_blood, Region::rv_blood, Region::la_blood, Region::ra_blood}) {
    const double volume = volume_ml(usual, region);
    EXPECT_NEAR(volume_ml(labels, region), volume, 0.06 * volume) << region_name(tag(region));
    EXPECT_NEAR(volume_ml(large, region), 1.728 * volume, 0.2 * volume) << region_name(tag(region));
  }
  overrides.rotation_deg = {0, 31, 0};
  EXPECT_THROW(make_heart_model(0, overrides), UserError);
}

}  // namespace
}  // namespace heartgen::phantom
