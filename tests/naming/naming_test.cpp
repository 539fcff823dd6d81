// SPDX-License-Identifier: GPL-3.0-or-later
// The naming as a whole: phantoms of kinds that patients have, and what must be refused for its true reason.
#include "generator/naming/naming.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/parallel/threads.hpp"
#include "model/crop.hpp"
#include "support/data.hpp"

namespace heartgen::naming {
namespace {

phantom::Phantom make(const phantom::GreyValues& grey = {}, int variant = 0, double noise_hu = 15) {
  phantom::PhantomSettings settings;
  settings.variant = variant;
  settings.size = {150, 150, 110};
  settings.spacing_mm = {2.2, 2.2, 2.8};
  settings.noise_hu = noise_hu;
  settings.companions = settings.fibers = false;
  settings.grey = grey;
  return phantom::make_phantom(settings);
}

struct Truth {
  Name name;
  const char* seed;
  Region region;
};
const std::vector<Truth> chambers_and_vessels = {
    {Name::lv, "lv_blood", Region::lv_blood}, {Name::la, "la_blood", Region::la_blood},
    {Name::rv, "rv_blood", Region::rv_blood}, {Name::ra, "ra_blood", Region::ra_blood},
    {Name::aorta, "aorta", Region::aorta},    {Name::pulmonary_artery, "pulmonary_artery", Region::pulmonary_artery}};

/// The share of a name's voxels that lie in its region.
double share_in(const Naming& naming, const phantom::HeartModel& model, Name name, Region region) {
  double all = 0, right = 0;
  const auto& names = naming.names;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < names.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < names.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < names.grid.size[0]; ++i, ++v) {
        if (names.voxels[v] != static_cast<std::uint8_t>(name)) continue;
        const Vec3 at =
            lps_from_index(names.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        ++all;
        right += phantom::region_at(model, at) == region;
      }
  return all > 0 ? right / all : 0;
}

void expect_right(const phantom::Phantom& p, const Naming& naming) {
  EXPECT_NE(naming.verdict, Verdict::no_heart) << (naming.reasons.empty() ? "" : naming.reasons.front());
  for (const auto& [name, seed, region] : chambers_and_vessels) {
    const auto& key = usual_of(name).key;
    EXPECT_GT(naming[name].ml, 10) << key;
    EXPECT_GT(share_in(naming, p.model, name, region), 0.75) << key;
  }
}

bool says(const Naming& naming, const std::string& word) {
  return std::any_of(naming.reasons.begin(), naming.reasons.end(),
                     [&](const std::string& reason) { return reason.find(word) != std::string::npos; });
}

std::string all_reasons(const Naming& naming) {
  std::string text;
  for (const auto& reason : naming.reasons) text += reason + "; ";
  return text;
}

class OnPhantom : public ::testing::TestWithParam<int> {};

TEST_P(OnPhantom, NamesLieOnTheirBodies) {
  const auto p = make({}, GetParam());
  const auto naming = name_blood(p.ct);
  expect_right(p, naming);
  EXPECT_GT(naming.mirrored_energy, naming.terms.sum());
}
INSTANTIATE_TEST_SUITE_P(Variants, OnPhantom, ::testing::Values(0, 7));

TEST(Naming, AllChambersEquallyBright) {
  phantom::GreyValues grey;
  grey.lv = grey.rv = grey.svc = 380;
  grey.ivc = 250;
  const auto p = make(grey);
  expect_right(p, name_blood(p.ct));
}

TEST(Naming, DenseContrastInTheCavaIsNoPulmonaryArtery) {
  phantom::GreyValues grey;
  grey.lv = 350;
  grey.rv = 300;
  grey.ra = 450;
  grey.pa = 310;
  grey.svc = 900;
  grey.muscle = 105;
  const auto p = make(grey);
  expect_right(p, name_blood(p.ct));
}

TEST(Naming, APulmonaryArteryBrighterThanItsVentricle) {
  phantom::GreyValues grey;
  grey.lv = 400;
  grey.rv = 200;
  grey.pa = 260;
  grey.svc = grey.ivc = 110;
  const auto p = make(grey);
  expect_right(p, name_blood(p.ct));
}

TEST(Naming, WithoutContrastThereIsNothingToName) {
  auto grey = phantom::grey_without_contrast();
  grey.vertebrae = 260;
  const auto naming = name_blood(make(grey).ct);
  EXPECT_EQ(naming.verdict, Verdict::no_heart);
  EXPECT_TRUE(says(naming, "not brighter than its muscle")) << all_reasons(naming);
}

TEST(Naming, AMirroredHeartIsToldToBeOne) {
  auto p = make();
  const CtVolume before = p.ct;
  const auto& size = before.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) p.ct(i, j, k) = before(size[0] - 1 - i, j, k);
  const auto naming = name_blood(p.ct);
  EXPECT_EQ(naming.verdict, Verdict::no_heart);
  ASSERT_FALSE(naming.reasons.empty());
  EXPECT_NE(naming.reasons.front().find("left and right are exchanged"), std::string::npos) << all_reasons(naming);
}

TEST(Naming, AHeartWithoutItsTopIsToldToBeCutThere) {
  auto p = make();
  Box box{{0, 0, 0}, p.ct.grid.size};
  const double top = p.landmarks.seeds_mm.at("la_blood").z + 5;
  box.end[2] = std::llround((top - p.ct.grid.origin_mm.z) / p.ct.grid.spacing_mm.z);
  const auto naming = name_blood(crop(p.ct, box));
  EXPECT_EQ(naming.verdict, Verdict::no_heart);
  EXPECT_TRUE(says(naming, "top")) << all_reasons(naming);
}

TEST(Naming, IsTheSameForAnyNumberOfThreads) {
  const auto p = make();
  const int before = parallel::thread_count();
  parallel::set_thread_count(1);
  const auto one = name_blood(p.ct);
  parallel::set_thread_count(3);
  const auto three = name_blood(p.ct);
  parallel::set_thread_count(before);
  EXPECT_EQ(one.names.voxels, three.names.voxels);
  EXPECT_EQ(one.terms.sum(), three.terms.sum());
  EXPECT_EQ(one.mirrored_energy, three.mirrored_energy);
}

/// Points set by eye inside the pools.
TEST(RealScans, ChambersAreNamed) {
  struct Scan {
    const char* file;
    std::map<Name, Vec3> points;
  };
  const std::vector<Scan> scans = {{"cardiac-cta-1.5mm/ct.nii.gz",
                                    {{Name::lv, {48, -186, 636}},
                                     {Name::la, {0.3, -146.2, 664.7}},
                                     {Name::rv, {30, -214, 645}},
                                     {Name::ra, {-16.2, -188.2, 639.2}}}},
                                   {"chest-ct-lidc-0001/ct.nii.gz",
                                    {{Name::lv, {63, -12, -184}},
                                     {Name::la, {20, 15.8, -172}},
                                     {Name::rv, {40, -41.2, -194}},
                                     {Name::ra, {-1, -29.2, -181}}}}};
  for (const auto& scan : scans) {
    const auto path = testing::real_data(scan.file);
    if (path.empty()) GTEST_SKIP() << "no real data on this machine";
    const auto naming = name_blood(adapters::read_ct(path));
    EXPECT_NE(naming.verdict, Verdict::no_heart) << scan.file << ": " << all_reasons(naming);
    for (const auto& [name, point] : scan.points) {
      const Vec3 index = index_from_lps(naming.names.grid, point);
      const auto found = naming.names(std::llround(index.x), std::llround(index.y), std::llround(index.z));
      EXPECT_EQ(usual_of(static_cast<Name>(found)).key, usual_of(name).key) << scan.file;
    }
  }
}

TEST(RealScans, WithoutContrastAreRefused) {
  const auto path = testing::real_data("chest-dicom-small");
  if (path.empty()) GTEST_SKIP() << "no real data on this machine";
  EXPECT_EQ(name_blood(adapters::read_ct(path)).verdict, Verdict::no_heart);
}

}  // namespace
}  // namespace heartgen::naming
