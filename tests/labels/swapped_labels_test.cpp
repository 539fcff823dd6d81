// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/swapped_labels.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/files.hpp"

namespace heartgen::labels {
namespace {

using enum Region;
using testing::error_of;

/// Boxes for the parts of a heart: ventricles side by side in their walls, atria and vessels above them.
LabelVolume boxes() {
  Grid grid;
  grid.size = {40, 30, 60};
  grid.spacing_mm = {2, 2, 2};
  LabelVolume labels(grid);
  const auto fill = [&](Region region, const Index3& from, const Index3& to) {
    for (auto k = from[2]; k < to[2]; ++k)
      for (auto j = from[1]; j < to[1]; ++j)
        for (auto i = from[0]; i < to[0]; ++i) labels(i, j, k) = tag(region);
  };
  fill(rv_myocardium, {2, 4, 4}, {18, 26, 30});
  fill(lv_myocardium, {16, 4, 4}, {38, 26, 30});
  fill(rv_blood, {4, 6, 6}, {16, 24, 30});
  fill(lv_blood, {20, 8, 8}, {34, 22, 30});
  fill(ra_blood, {4, 6, 30}, {14, 16, 50});
  fill(la_blood, {20, 8, 30}, {34, 16, 50});
  fill(pulmonary_artery, {6, 17, 30}, {14, 24, 50});
  fill(aorta, {24, 17, 30}, {31, 22, 50});
  return labels;
}

LabelVolume swapped(LabelVolume labels, Region a, Region b) {
  for (auto& label : labels.voxels) label = label == tag(a) ? tag(b) : label == tag(b) ? tag(a) : label;
  return labels;
}

TEST(ExchangedRegions, AreRefusedByName) {
  refuse_exchanged_regions(boxes(), "seg.nrrd");
  for (const auto& [a, b] :
       {std::pair{lv_blood, rv_blood}, std::pair{lv_myocardium, rv_myocardium}, std::pair{la_blood, ra_blood},
        std::pair{aorta, pulmonary_artery}, std::pair{lv_blood, la_blood}, std::pair{rv_blood, ra_blood},
        std::pair{lv_blood, lv_myocardium}}) {
    const auto message = error_of([&, a = a, b = b] { refuse_exchanged_regions(swapped(boxes(), a, b), "seg.nrrd"); });
    for (const auto& word : {std::string("seg.nrrd"), region_name(tag(a)), region_name(tag(b))})
      EXPECT_NE(message.find(word), std::string::npos) << word << " not in: " << message;
  }
}

TEST(ExchangedRegions, LeftAndRightThroughoutAreTold) {
  auto labels = boxes();
  for (const auto& [a, b] : {std::pair{lv_blood, rv_blood}, std::pair{lv_myocardium, rv_myocardium},
                             std::pair{la_blood, ra_blood}, std::pair{aorta, pulmonary_artery}})
    labels = swapped(std::move(labels), a, b);
  const auto message = error_of([&] { refuse_exchanged_regions(labels, "seg.nrrd"); });
  EXPECT_NE(message.find("the left and the right heart"), std::string::npos) << message;
}

TEST(ExchangedRegions, WhatIsMissingSaysNothing) {
  for (int missing = 1; missing <= tag(torso); ++missing) {
    auto labels = boxes();
    std::replace(labels.voxels.begin(), labels.voxels.end(), static_cast<std::uint8_t>(missing), std::uint8_t{0});
    refuse_exchanged_regions(labels, "seg.nrrd");
  }
}

}  // namespace
}  // namespace heartgen::labels
