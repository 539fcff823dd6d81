// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/median.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <random>

#include "model/error.hpp"

namespace heartgen::pde {
namespace {

template <class T>
parallel::Slab<T> slab_of(const std::vector<T>& values) {
  Grid grid;
  grid.size = {static_cast<std::int64_t>(values.size()), 1, 1};
  Volume<T> volume(grid);
  volume.voxels = values;
  return parallel::scatter(volume, parallel::self());
}

template <class T>
T lower_median(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class T>
void expect_median(const std::vector<T>& values) {
  const std::vector<std::uint8_t> all(values.size(), 1);
  const auto found = pde::median(slab_of(values), slab_of(all), 1, parallel::self());
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(*found, lower_median(values));
}

TEST(Median, OfFloatsEqualsNthElement) {
  std::mt19937 random(3);
  for (const std::size_t size : {1u, 2u, 3u, 10u, 1001u, 20000u}) {
    std::vector<float> values(size);
    for (auto& v : values) {  // every exponent and sign
      do v = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      while (!(std::abs(v) < 3e38f));
      v += 0.0f;
    }
    expect_median(values);
    for (auto& v : values) v = static_cast<float>(random() % 5) - 2.5f;  // ties
    expect_median(values);
    expect_median(std::vector<float>(size, -7.25f));
  }
}

TEST(Median, CountsOnlyTheLabelledVoxels) {
  const auto values = slab_of(std::vector<float>{5, -1, 100, 3, 100, 4});
  const auto labels = slab_of(std::vector<std::uint8_t>{1, 1, 2, 1, 2, 0});
  EXPECT_EQ(pde::median(values, labels, 1, parallel::self()), 3.0f);
  EXPECT_EQ(pde::median(values, labels, 2, parallel::self()), 100.0f);
  EXPECT_EQ(pde::median(values, labels, 7, parallel::self()), std::nullopt);
}

TEST(Median, RefusesWhatIsNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()}) {
    const auto values = slab_of(std::vector<float>{5, bad, 1});
    EXPECT_THROW(pde::median(values, slab_of(std::vector<std::uint8_t>{1, 1, 1}), 1, parallel::self()), UserError);
    EXPECT_EQ(pde::median(values, slab_of(std::vector<std::uint8_t>{1, 0, 1}), 1, parallel::self()), 1.0f);
  }
  const float largest = std::numeric_limits<float>::max();
  expect_median(std::vector<float>{largest, -largest, largest});
  expect_median(std::vector<float>{std::numeric_limits<float>::denorm_min(), -largest, 0});
}

}  // namespace
}  // namespace heartgen::pde
