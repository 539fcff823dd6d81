// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/hounsfield.hpp"

#include <gtest/gtest.h>

#include "model/error.hpp"

namespace heartgen::anatomy {
namespace {

/// Muscle with a layer of fat on two slices of ten.
CtVolume slab_of_fat(int offset) {
  Grid grid;
  grid.size = {6, 6, 10};
  CtVolume ct(grid, static_cast<std::int16_t>(60 + offset));
  for (std::int64_t k = 0; k < 2; ++k)
    for (std::int64_t j = 0; j < 6; ++j)
      for (std::int64_t i = 0; i < 6; ++i) ct(i, j, k) = static_cast<std::int16_t>(-100 + offset);
  return ct;
}

TEST(Hounsfield, AFewVoxelsOfFatAreEnough) { EXPECT_NO_THROW(anatomy::require_hounsfield(slab_of_fat(0))); }

TEST(Hounsfield, ALostRescaleIsNamedWithItsValues) {
  try {
    anatomy::require_hounsfield(slab_of_fat(1024));
    FAIL() << "accepted";
  } catch (const UserError& error) {
    EXPECT_NE(error.problem.find("924 to 1084"), std::string::npos) << error.problem;
    EXPECT_NE(error.remedy.find("1024"), std::string::npos);
  }
}

TEST(Hounsfield, ALabelMapIsNamedAsSuch) {
  CtVolume labels = slab_of_fat(100);  // 0 and 160
  try {
    anatomy::require_hounsfield(labels, "labels.nii.gz");
    FAIL() << "accepted";
  } catch (const UserError& error) {
    EXPECT_NE(error.problem.find("0 to 160"), std::string::npos) << error.problem;
    EXPECT_EQ(error.where, "labels.nii.gz");
    EXPECT_NE(error.remedy.find("label map"), std::string::npos) << error.remedy;
  }
  labels.voxels.front() = -1;  // no background of 0: too little to judge by
  EXPECT_NO_THROW(anatomy::require_hounsfield(labels));
}

}  // namespace
}  // namespace heartgen::anatomy
