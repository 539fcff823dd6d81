// SPDX-License-Identifier: GPL-3.0-or-later
// Grey values of the phantom's parts as options: each part's own, others untouched, mistakes told.
#include <gtest/gtest.h>

#include "datasets/phantom/phantom.hpp"
#include "model/error.hpp"
#include "model/quantile.hpp"

namespace heartgen::phantom {
namespace {

Phantom made(const GreyValues& grey) {
  PhantomSettings settings;
  settings.size = {100, 100, 70};
  settings.spacing_mm = {3, 3, 4};
  settings.noise_hu = 0;
  settings.companions = settings.fibers = false;
  settings.grey = grey;
  return make_phantom(settings);
}

/// Median of a region's voxels: most of them hold nothing else.
double grey_of(const Phantom& p, const char* name) {
  std::vector<std::int16_t> values;
  for (std::size_t v = 0; v < p.ct.voxels.size(); ++v)
    if (p.labels.voxels[v] == tag(*region_from_name(name))) values.push_back(p.ct.voxels[v]);
  return upper_median(values);
}

TEST(GreyValues, EachPartHasItsOwn) {
  GreyValues grey;
  for (const char* assignment : {"lv=350", "rv=300", "ra=450", "pa=310", "svc=900", "muscle=105"})
    set_grey(grey, assignment);
  const auto p = made(grey);
  EXPECT_NEAR(grey_of(p, "lv_blood"), 350, 1);
  EXPECT_NEAR(grey_of(p, "la_blood"), 350, 1);
  EXPECT_NEAR(grey_of(p, "aorta"), 350, 1);
  EXPECT_NEAR(grey_of(p, "rv_blood"), 300, 1);
  EXPECT_NEAR(grey_of(p, "ra_blood"), 450, 1);
  EXPECT_NEAR(grey_of(p, "pulmonary_artery"), 310, 1);
}

TEST(GreyValues, LeaveEverythingElseAsItIs) {
  const auto plain = made({});
  GreyValues grey;
  grey.svc = 900;
  const auto dense = made(grey);
  EXPECT_EQ(plain.labels.voxels, dense.labels.voxels);
  std::size_t brighter = 0, darker = 0;
  for (std::size_t v = 0; v < plain.ct.voxels.size(); ++v) {
    brighter += dense.ct.voxels[v] > plain.ct.voxels[v];
    darker += dense.ct.voxels[v] < plain.ct.voxels[v];
  }
  EXPECT_GT(brighter, 300U);
  EXPECT_LT(brighter, 6000U);
  EXPECT_EQ(darker, 0U);
}

TEST(GreyValues, AJetRunsThroughTheRightAtriumAlone) {
  GreyValues grey;
  grey.ra = 180;
  grey.jet = 700;
  const auto p = made(grey);
  std::size_t jet = 0, outside = 0, rest = 0;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < p.ct.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < p.ct.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < p.ct.grid.size[0]; ++i, ++v) {
        const Vec3 at =
            lps_from_index(p.ct.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const bool is_jet = tissue_at(p.model, at) == Tissue::jet;
        jet += is_jet;
        outside += is_jet && p.labels.voxels[v] != tag(Region::ra_blood);
        rest += tissue_at(p.model, at) == Tissue::ra_blood;
      }
  EXPECT_GT(jet, 100U);
  EXPECT_EQ(outside, 0U);
  EXPECT_GT(rest, jet);
}

TEST(GreyValues, WithoutContrastBloodIsAsDarkAsMuscle) {
  const auto p = made(grey_without_contrast());
  for (const char* name : {"lv_blood", "la_blood", "rv_blood", "ra_blood", "aorta", "pulmonary_artery"})
    EXPECT_NEAR(grey_of(p, name), 45, 8) << name;
}

TEST(GreyValues, MistakesAreTold) {
  GreyValues grey;
  for (const char* wrong : {"lv", "lv=", "lv=bright", "lv=3 5", "left=350", "=350", ""})
    EXPECT_THROW(set_grey(grey, wrong), UserError) << wrong;
  try {
    set_grey(grey, "svcc=900");
  } catch (const UserError& error) {
    EXPECT_NE(error.remedy.find("svc"), std::string::npos) << error.what();
  }
  grey.lv = 1e5;
  EXPECT_THROW(make_heart_model(0, {}, grey), UserError);
}

}  // namespace
}  // namespace heartgen::phantom
