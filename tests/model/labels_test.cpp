// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/labels.hpp"

#include <gtest/gtest.h>

#include <set>

#include "model/error.hpp"
#include "model/grid.hpp"
#include "model/text.hpp"
#include "model/volume.hpp"

namespace heartgen {
namespace {

TEST(Labels, NamesAndTagsAreOneToOne) {
  std::set<std::string> names;
  for (const auto& row : region_table()) {
    EXPECT_EQ(region_name(row.tag), row.name);
    EXPECT_EQ(tag(*region_from_name(row.name)), row.tag);
    EXPECT_TRUE(names.insert(std::string(row.name)).second);
  }
  for (const auto& row : surface_table()) EXPECT_EQ(surface_from_name(row.name), row.tag);
  EXPECT_FALSE(region_from_name("left_ventricle"));
}

/// gmshToFoam and others keep one table of numbers and names for all dimensions.
TEST(Labels, NoSurfaceHasTheTagOfARegion) {
  for (const auto& row : region_table()) EXPECT_TRUE(row.tag >= 1 && row.tag <= 99) << row.name;
  std::set<std::int32_t> tags;
  for (const auto& row : surface_table()) {
    EXPECT_TRUE(row.tag >= 101 && row.tag <= 199) << row.name;
    EXPECT_TRUE(tags.insert(row.tag).second) << row.name;
  }
  for (int number = 1; number < 100; ++number)
    for (const Region vessel :
         {Region::trachea, Region::carotid, Region::aorta, Region::pulmonary_artery, Region::la_blood})
      EXPECT_TRUE(tags.insert(end_surface_tag(vessel, number)).second) << number;
  for (const auto tag : tags) EXPECT_FALSE(is_cap(tag)) << tag;
  for (const auto& row : region_table()) EXPECT_LT(row.tag, first_user_region) << row.name;
}

TEST(Labels, CapsAreCalledAfterTheirOpenings) {
  const auto mitral = *surface_from_name("mitral_orifice");
  EXPECT_EQ(surface_name(cap_tag(mitral)), "mitral_orifice_cap");
  EXPECT_EQ(surface_from_name("mitral_orifice_cap"), 2000 + mitral);
  EXPECT_EQ(surface_from_name("pulmonary_vein_end_2_cap"), 2602);
  EXPECT_FALSE(surface_from_name("mitral_cap"));
}

TEST(Labels, AnnuliAreWallsOfTheirAtriaThatNoLabelMapHolds) {
  using enum Region;
  for (const auto& [annulus, wall] : {std::pair{la_annulus, la_wall}, std::pair{ra_annulus, ra_wall}}) {
    EXPECT_TRUE(is_myocardium(annulus) && is_annulus(annulus) && !is_label(annulus) && is_label(wall));
    EXPECT_EQ(surface_name(surface_between(annulus, wall)), "annulus_border");
    for (const Region other : {lv_myocardium, rv_blood, la_blood, torso, none, lung, aorta})
      EXPECT_EQ(surface_between(annulus, other), surface_between(wall, other)) << tag(other);
  }
  EXPECT_EQ(surface_between(la_annulus, ra_annulus), surface_between(la_wall, ra_wall));
  EXPECT_EQ(surface_between(la_annulus, ra_wall), surface_between(la_wall, ra_wall));
}

TEST(Labels, EndsAreNumbered) {
  EXPECT_EQ(surface_name(end_surface_tag(Region::trachea, 3)), "trachea_end_3");
  EXPECT_EQ(surface_from_name("carotid_end_12"), end_surface_tag(Region::carotid, 12));
  EXPECT_EQ(surface_name(end_surface_tag(Region::aorta, 2)), "aorta_end_2");
  EXPECT_NE(surface_from_name("aorta_end"), surface_from_name("aorta_end_1"));
  EXPECT_FALSE(surface_from_name("carotid_end_"));
  EXPECT_FALSE(surface_from_name("carotid_end_1x"));
}

TEST(Labels, EveryPairOfRegionsHasOneNamedSurfaceWhateverTheOrder) {
  for (int a = 0; a <= tag(Region::torso); ++a)
    for (int b = 0; b <= tag(Region::torso); ++b) {
      if (a == b) continue;
      const auto surface = surface_between(static_cast<Region>(a), static_cast<Region>(b));
      EXPECT_EQ(surface, surface_between(static_cast<Region>(b), static_cast<Region>(a))) << a << " " << b;
      EXPECT_TRUE(surface_from_name(surface_name(surface))) << a << " " << b;
    }
}

TEST(Labels, ValvesLieBetweenTheirPools) {
  EXPECT_EQ(surface_name(surface_between(Region::lv_blood, Region::la_blood)), "mitral_orifice");
  EXPECT_EQ(surface_name(surface_between(Region::aorta, Region::lv_blood)), "aortic_orifice");
  EXPECT_EQ(surface_name(surface_between(Region::ra_blood, Region::rv_blood)), "tricuspid_orifice");
  EXPECT_EQ(surface_name(surface_between(Region::rv_blood, Region::pulmonary_artery)), "pulmonary_orifice");
}

TEST(Labels, WallsHaveAnInsideAndAnOutside) {
  EXPECT_EQ(surface_name(surface_between(Region::lv_myocardium, Region::lv_blood)), "lv_endocardium");
  EXPECT_EQ(surface_name(surface_between(Region::lv_myocardium, Region::rv_blood)), "rv_endocardium");
  EXPECT_EQ(surface_name(surface_between(Region::la_wall, Region::la_blood)), "la_endocardium");
  for (const Region outside : {Region::none, Region::torso, Region::lung, Region::liver})
    EXPECT_EQ(surface_name(surface_between(Region::rv_myocardium, outside)), "epicardium");
}

TEST(Grid, IndexAndPositionAreInverse) {
  Grid grid;
  grid.size = {10, 20, 30};
  grid.spacing_mm = {0.5, 0.75, 2};
  grid.origin_mm = {-100, 50, 3};
  const double c = 0.6, s = 0.8;
  grid.direction = {{Vec3{c, -s, 0}, Vec3{s, c, 0}, Vec3{0, 0, 1}}};
  const Vec3 index{3.25, 7.5, 11};
  const Vec3 back = index_from_lps(grid, lps_from_index(grid, index));
  EXPECT_NEAR(norm(back - index), 0, 1e-12);
}

TEST(Volume, LinearSamplingIsExactForLinearImagesAndContinuesTheBorder) {
  Grid grid;
  grid.size = {4, 3, 2};
  Volume<float> volume(grid);
  for (std::int64_t k = 0; k < 2; ++k)
    for (std::int64_t j = 0; j < 3; ++j)
      for (std::int64_t i = 0; i < 4; ++i) volume(i, j, k) = static_cast<float>(1 + 2 * i - j + 5 * k);
  EXPECT_NEAR(sample_linear(volume, {1.5, 0.25, 0.75}), 1 + 3 - 0.25 + 3.75, 1e-6);
  EXPECT_NEAR(sample_linear(volume, {-5, 0, 0}), 1, 1e-6);
  EXPECT_NEAR(sample_linear(volume, {9, 9, 9}), 1 + 6 - 2 + 5, 1e-6);
}

TEST(Text, NearestNameAndNumbers) {
  EXPECT_EQ(nearest_name("lamda", {"mu", "lambda", "name"}), "lambda");
  EXPECT_EQ(nearest_name("edge_mm", {"meshes", "heart_edge_mm"}), "heart_edge_mm");
  EXPECT_EQ(nearest_name("heart_edge", {"heart", "heart_edg_mm"}), "heart_edg_mm");
  EXPECT_EQ(number_text(2), "2.0");
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(parse_number("-2.5e3", "x"), -2500);
  EXPECT_THROW(parse_number("2mm", "x"), UserError);
  EXPECT_THROW(parse_number("", "x"), UserError);
}

}  // namespace
}  // namespace heartgen
