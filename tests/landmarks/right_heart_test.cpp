// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of the right heart on label maps of boxes.
#include "generator/landmarks/right_heart.hpp"

#include <gtest/gtest.h>

#include "model/labels.hpp"

namespace heartgen::landmarks {
namespace {

void fill(LabelVolume& labels, const Index3& begin, const Index3& end, Region region) {
  for (std::int64_t k = begin[2]; k < end[2]; ++k)
    for (std::int64_t j = begin[1]; j < end[1]; ++j)
      for (std::int64_t i = begin[0]; i < end[0]; ++i) labels(i, j, k) = tag(region);
}

LabelVolume empty_map() {
  Grid grid;
  grid.size = {20, 20, 40};
  grid.spacing_mm = {1.5, 1.5, 1.5};
  return LabelVolume(grid);
}

TEST(MainPieces, ThePulmonaryArteryIsThePieceBesideItsVentricle) {
  LabelVolume labels = empty_map();
  fill(labels, {2, 2, 2}, {12, 12, 12}, Region::rv_blood);
  fill(labels, {4, 4, 12}, {8, 8, 18}, Region::pulmonary_artery);
  fill(labels, {0, 0, 24}, {20, 20, 40}, Region::pulmonary_artery);  // the neck
  keep_main_pieces(labels);
  EXPECT_EQ(labels(5, 5, 15), tag(Region::pulmonary_artery));
  EXPECT_EQ(labels(5, 5, 30), 0);
}

TEST(MainPieces, TheLargestWhereNoneTouchesTheVentricle) {
  LabelVolume labels = empty_map();
  fill(labels, {2, 2, 2}, {12, 12, 10}, Region::rv_blood);
  fill(labels, {4, 4, 12}, {8, 8, 18}, Region::pulmonary_artery);
  fill(labels, {0, 0, 24}, {20, 20, 40}, Region::pulmonary_artery);
  keep_main_pieces(labels);
  EXPECT_EQ(labels(5, 5, 15), 0);
  EXPECT_EQ(labels(5, 5, 30), tag(Region::pulmonary_artery));
}

}  // namespace
}  // namespace heartgen::landmarks
