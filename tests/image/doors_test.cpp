// SPDX-License-Identifier: GPL-3.0-or-later
// What the room refuses from its callers.
#include <gtest/gtest.h>

#include "generator/image/distance.hpp"
#include "generator/image/flood.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/morphology.hpp"
#include "generator/image/statistics.hpp"
#include "model/contract.hpp"

namespace heartgen::image {
namespace {

Mask mask_of(std::int64_t side) {
  Grid grid;
  grid.size = {side, side, side};
  return Mask(grid);
}

TEST(Doors, MasksOfTwoGrids) {
  EXPECT_THROW(unite(mask_of(3), mask_of(4)), ContractViolation);
  EXPECT_THROW(intersect(mask_of(3), mask_of(4)), ContractViolation);
  EXPECT_THROW(subtract(mask_of(3), mask_of(4)), ContractViolation);
  EXPECT_THROW(geodesic_distance(mask_of(3), mask_of(4), 10), ContractViolation);
}

TEST(Doors, LengthsBelowZero) {
  EXPECT_THROW(dilate(mask_of(3), -1), ContractViolation);
  EXPECT_THROW(erode(mask_of(3), -1), ContractViolation);
  EXPECT_THROW(gaussian(Volume<float>(mask_of(3).grid), -1), ContractViolation);
  EXPECT_THROW(nearest_label(mask_of(3), -1), ContractViolation);
}

TEST(Doors, StatisticsOfNothing) {
  std::vector<float> none;
  EXPECT_THROW(two_medians(none, 0.2, 0.8), ContractViolation);
  EXPECT_THROW(principal_axes({}), ContractViolation);
}

}  // namespace
}  // namespace heartgen::image
