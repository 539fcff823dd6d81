// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/quantile.hpp"

#include <gtest/gtest.h>

#include <random>

namespace heartgen {
namespace {

TEST(Quantile, IsTheElementOfTheSortedValues) {
  std::mt19937 random(1);
  for (std::size_t count = 1; count < 40; ++count) {
    std::vector<int> values(count);
    for (int& v : values) v = static_cast<int>(random() % 12);  // ties
    std::vector<int> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t rank = 0; rank < count; ++rank) EXPECT_EQ(ranked(values, rank), sorted[rank]);
    EXPECT_EQ(lower_median(values), sorted[(count - 1) / 2]);
    EXPECT_EQ(upper_median(values), sorted[count / 2]);
    EXPECT_EQ(quantile(values, 0), sorted.front());
    EXPECT_EQ(quantile(values, 1), sorted.back());
    std::sort(values.begin(), values.end());
    EXPECT_EQ(values, sorted) << "nothing is lost";
  }
}

TEST(Quantile, RoundsItsRankDown) {
  std::vector<double> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(quantile(values, 0.49), 2);
  EXPECT_EQ(quantile(values, 0.5), 3);
  EXPECT_EQ(quantile(values, 0.99), 4);
}

}  // namespace
}  // namespace heartgen
