// SPDX-License-Identifier: GPL-3.0-or-later
// Real scans without a landmark: every chamber is found and is as large as hearts have them.
#include <gtest/gtest.h>

#include <algorithm>

#include "generator/adapters/itk_io.hpp"
#include "generator/pipeline/image_stages.hpp"
#include "support/data.hpp"

namespace heartgen::app {
namespace {

struct Usual {
  Region region;
  double min_ml, max_ml;
};
constexpr Usual usual[] = {
    {Region::lv_blood, 40, 250}, {Region::rv_blood, 40, 250},     {Region::la_blood, 30, 200},
    {Region::ra_blood, 25, 200}, {Region::aorta, 10, 60},         {Region::pulmonary_artery, 10, 60},
    {Region::la_wall, 5, 60},    {Region::ra_wall, 5, 60},        {Region::rv_myocardium, 15, 80},
    {Region::papillary, 1, 20},  {Region::lv_myocardium, 40, 250}};

double volume_ml(const LabelVolume& labels, Region region) {
  const auto voxels = std::count(labels.voxels.begin(), labels.voxels.end(), tag(region));
  return static_cast<double>(voxels) * labels.grid.voxel_volume_mm3() / 1000;
}

class RealScans : public ::testing::TestWithParam<const char*> {};

TEST_P(RealScans, HaveAllChambersWithoutALandmark) {
  const std::string file = testing::real_data(GetParam());
  if (file.empty()) GTEST_SKIP() << GetParam() << " is not on this machine";
  pipeline::Build build;
  build.run.comm = parallel::self();
  build.ct.value = adapters::read_ct(file);
  build.recipe.segmentation = default_segmentation();
  run_stages(pipeline::joined({pipeline::landmark_stages(), pipeline::label_stages()}), build);
  for (const auto& [region, min_ml, max_ml] : usual) {
    EXPECT_GT(volume_ml(*build.heart, region), min_ml) << region_name(tag(region));
    EXPECT_LT(volume_ml(*build.heart, region), max_ml) << region_name(tag(region));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, RealScans,
                         ::testing::Values("cardiac-cta-1.5mm/ct.nii.gz", "chest-ct-lidc-0001/ct.nii.gz"));

}  // namespace
}  // namespace heartgen::app
