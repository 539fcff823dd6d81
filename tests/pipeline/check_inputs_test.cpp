// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/check_inputs.hpp"

#include <gtest/gtest.h>

#include "model/labels.hpp"
#include "support/files.hpp"

namespace heartgen::pipeline {
namespace {

/// A column of blood in muscle, 24 mm wide, whose ends lie `gap` voxels from the ends of the image.
LabelVolume column(std::int64_t gap) {
  Grid grid;
  grid.size = {40, 40, 40};
  grid.spacing_mm = {2, 2, 2};
  LabelVolume labels(grid, tag(Region::torso));
  for (std::int64_t k = gap; k < 40 - gap; ++k)
    for (std::int64_t j = 14; j < 26; ++j)
      for (std::int64_t i = 14; i < 26; ++i) {
        const bool inside = i > 16 && i < 23 && j > 16 && j < 23;
        labels(i, j, k) = tag(inside ? Region::lv_blood : Region::lv_myocardium);
      }
  return labels;
}

TEST(CutVentricles, AreRefusedWhereMoreThanTheirTipIsMissing) {
  pipeline::refuse_cut_ventricles(column(1), {});
  const auto message = testing::error_of([] { pipeline::refuse_cut_ventricles(column(0), {}); });
  EXPECT_NE(message.find("over 12 cm2"), std::string::npos) << message;
  LabelVolume tip = column(1);
  for (std::int64_t j = 16; j < 20; ++j)
    for (std::int64_t i = 16; i < 20; ++i) tip(i, j, 0) = tag(Region::lv_myocardium);
  pipeline::refuse_cut_ventricles(tip, {});
  LabelVolume aorta(tip.grid, tag(Region::aorta));  // vessels and atria may well leave the image
  pipeline::refuse_cut_ventricles(aorta, {});
  anatomy::Padding above;  // of all rows from the column's side on: beside it nothing was measured
  above.width = 40;
  above.is_slice.resize(40, 0);
  for (int c = 0; c < 40 * 40; ++c) above.is_column.push_back(c / 40 >= 26);
  EXPECT_NE(testing::error_of([&] { pipeline::refuse_cut_ventricles(column(1), above); }).find("cuts"),
            std::string::npos);
}

}  // namespace
}  // namespace heartgen::pipeline
