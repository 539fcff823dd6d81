// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/modal_intensity.hpp"

#include <gtest/gtest.h>

#include "model/tissue.hpp"

namespace heartgen::image {
namespace {

TEST(TypicalGrey, IsTheMedianOfTheFullestWindow) {
  std::vector<float> values{7, 300, 104, 100, 101, 40, 150, 102, 103};
  EXPECT_EQ(image::modal_intensity(values, 10), 102);
  EXPECT_EQ(image::modal_intensity(values, 3), 102);  // 100 to 103 and 101 to 104 hold four: the lower window counts
  EXPECT_EQ(image::modal_intensity(values, 1000), 102);
}

/// Their plain median is 89.
TEST(TypicalGrey, MixturesWithFatHardlyShiftIt) {
  std::vector<float> values;
  for (int n = 0; n < 1000; ++n) {
    values.push_back(110 + static_cast<float>(n % 41 - 20));         // muscle and noise
    if (n < 900) values.push_back(static_cast<float>(n % 100) - 1);  // every share of fat alike
  }
  EXPECT_NEAR(image::modal_intensity(values, tissue::muscle_window_hu), 110, 5);
}

TEST(TypicalGrey, OfNothingIsZero) {
  std::vector<float> none;
  EXPECT_EQ(image::modal_intensity(none, tissue::muscle_window_hu), 0);
}

}  // namespace
}  // namespace heartgen::image
