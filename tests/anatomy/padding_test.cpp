// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/padding.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace heartgen;

constexpr std::int16_t lung_hu = -850, tissue_hu = 40, padding_hu = -2048;

Grid grid_of(const std::array<std::int64_t, 3>& size) {
  Grid grid;
  grid.size = size;
  grid.spacing_mm = {1, 1.5, 2};
  return grid;
}

// A chest without air around it: two lungs of even size in tissue, a little noise.
CtVolume chest(const Grid& grid) {
  CtVolume ct(grid);
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const bool is_lung = std::abs(i - grid.size[0] / 2) > grid.size[0] / 6;
        ct.voxels[v] = static_cast<std::int16_t>((is_lung ? lung_hu : tissue_hu) + static_cast<int>(v * 7 % 11));
      }
  return ct;
}

// Of the plane across `axis`, whether a place lies in the disc that was measured.
bool in_disc(const Grid& grid, const Index3& at, std::size_t axis) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (a == axis) continue;
    const double half = 0.5 * static_cast<double>(grid.size[a] - 1);
    sum += std::pow((static_cast<double>(at[a]) - half) / (0.9 * half), 2);
  }
  return sum < 1;
}

template <class Inside>
CtVolume padded(CtVolume ct, Inside&& inside) {
  std::size_t v = 0;
  for (std::int64_t k = 0; k < ct.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < ct.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < ct.grid.size[0]; ++i, ++v)
        if (!inside(Index3{i, j, k})) ct.voxels[v] = padding_hu;
  return ct;
}

std::int64_t neighbours_empty(const CtVolume& ct, const Index3& at) {
  std::int64_t count = 0;
  for (std::size_t a = 0; a < 3; ++a)
    for (const std::int64_t way : {-1, 1}) {
      Index3 next = at;
      next[a] += way;
      count += ct.grid.contains(next[0], next[1], next[2]) && ct(next[0], next[1], next[2]) <= -1000;
    }
  return count;
}

TEST(Padding, AWallClosesWhatADiscCutsAndIsTakenBack) {
  const auto grid = grid_of({60, 56, 50});
  for (const std::size_t axis : {2U, 1U, 0U}) {
    const auto ct = padded(chest(grid), [&](const Index3& at) { return in_disc(grid, at, axis); });
    const auto padding = anatomy::find_padding(ct);
    ASSERT_TRUE(padding.is_there()) << axis;
    EXPECT_EQ(padding.axis, axis);
    EXPECT_EQ(padding.value_hu, padding_hu);
    auto closed = ct;
    anatomy::close_padding(closed, padding);
    LabelVolume labels(grid, 1);
    anatomy::clear_padding(labels, padding);
    std::size_t v = 0;
    for (std::int64_t k = 0; k < grid.size[2]; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
          const bool was_measured = ct.voxels[v] != padding_hu;
          ASSERT_EQ(labels.voxels[v] == 1, was_measured);
          ASSERT_EQ(padding.covers({i, j, k}), !was_measured);
          if (!was_measured) continue;
          ASSERT_EQ(closed.voxels[v], ct.voxels[v]);
          ASSERT_EQ(neighbours_empty(closed, {i, j, k}), 0);
        }
    anatomy::reopen_padding(closed, padding);
    for (std::size_t at = 0; at < ct.voxels.size(); ++at)  // no value is left that the rest did not have, or air
      ASSERT_TRUE(closed.voxels[at] == ct.voxels[at] || (ct.voxels[at] == padding_hu && closed.voxels[at] == -1024));
  }
}

TEST(Padding, BesideABoxAndEmptySlicesIsFound) {
  const auto grid = grid_of({40, 36, 30});
  const auto ct = padded(chest(grid), [&](const Index3& at) { return at[0] > 9 && at[2] > 3; });
  const auto padding = anatomy::find_padding(ct);
  ASSERT_TRUE(padding.is_there());
  EXPECT_TRUE(padding.covers({9, 20, 20}) && padding.covers({20, 20, 3}));
  EXPECT_FALSE(padding.covers({10, 20, 20}));
  EXPECT_EQ(padding.wall.size(), 10U * 36U);  // as far as there are 12 mm
  EXPECT_EQ(padding.lids, (std::vector<std::int64_t>{3, 2, 1, 0}));
}

TEST(Padding, EmptySlicesAreClosedAtEitherEnd) {
  const auto grid = grid_of({40, 36, 30});
  for (const bool at_end : {false, true}) {
    const auto ct = padded(chest(grid), [&](const Index3& at) { return at_end ? at[2] < 20 : at[2] > 9; });
    const auto padding = anatomy::find_padding(ct);
    ASSERT_TRUE(padding.is_there());
    EXPECT_EQ(padding.lids.size(), 6U);
    auto closed = ct;
    anatomy::close_padding(closed, padding);
    EXPECT_EQ(closed(3, 4, at_end ? 20 : 9), -80);
    EXPECT_EQ(closed(3, 4, at_end ? 26 : 3), -1024);
  }
}

TEST(Padding, AirAroundABodyIsNone) {
  const auto grid = grid_of({40, 36, 30});
  // A body that was cut out of its air, wider in some slices; its lungs do not reach the skin.
  const auto body = padded(chest(grid), [&](const Index3& at) {
    const double r = std::hypot(static_cast<double>(at[0]) - 20, static_cast<double>(at[1]) - 18);
    return r < 10 + static_cast<double>(at[2] % 6);
  });
  EXPECT_FALSE(anatomy::find_padding(body).is_there());
  auto noisy = chest(grid);  // measured everywhere, a corner of air
  for (std::size_t v = 0; v < noisy.voxels.size(); ++v)
    if (v % 40 < 5) noisy.voxels[v] = static_cast<std::int16_t>(-1000 + static_cast<int>(v % 13));
  EXPECT_FALSE(anatomy::find_padding(noisy).is_there());
  EXPECT_FALSE(anatomy::find_padding(chest(grid)).is_there());
  EXPECT_FALSE(anatomy::find_padding(CtVolume{}).is_there());
}

}  // namespace
