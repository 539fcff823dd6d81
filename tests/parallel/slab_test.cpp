// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/parallel/slab.hpp"

#include <gtest/gtest.h>

namespace heartgen::parallel {
namespace {

TEST(OwnedSlices, CoverTheImageEvenlyForAnyNumberOfRanks) {
  for (const std::int64_t slices : {1, 2, 3, 10, 199})
    for (const int size : {1, 2, 3, 5, 16}) {
      std::int64_t next = 0;
      for (int rank = 0; rank < size; ++rank) {
        const auto range = owned_slices(slices, {0, size}, rank);
        EXPECT_EQ(range.begin, next);
        EXPECT_LE(range.end - range.begin, (slices + size - 1) / size);
        next = range.end;
      }
      EXPECT_EQ(next, slices);
    }
}

Volume<float> numbered(Index3 size) {
  Grid grid;
  grid.size = size;
  Volume<float> volume(grid);
  for (std::size_t i = 0; i < volume.voxels.size(); ++i) volume.voxels[i] = static_cast<float>(i);
  return volume;
}

TEST(Slab, ScatterAndGatherAreInverse) {
  for (const Index3 size : {Index3{4, 3, 5}, Index3{4, 3, 1}, Index3{1, 1, 1}}) {
    const auto volume = numbered(size);
    const auto slab = scatter(volume, self(), 2);
    const auto back = gather(slab, self());
    EXPECT_EQ(back.grid, volume.grid);
    EXPECT_EQ(back.voxels, volume.voxels);
  }
}

TEST(Slab, GhostsBeyondTheImageRepeatItsBorder) {
  const auto volume = numbered({4, 3, 5});
  const auto slab = scatter(volume, self(), 2);
  for (std::int64_t k = -2; k < 7; ++k)
    for (std::int64_t j = 0; j < 3; ++j)
      for (std::int64_t i = 0; i < 4; ++i)
        EXPECT_EQ(slab.row(j, k)[i], volume(i, j, std::clamp<std::int64_t>(k, 0, 4)));
}

TEST(Slab, RowSumsDoNotDependOnThreads) {
  auto volume = numbered({31, 17, 5});
  for (auto& v : volume.voxels) v = 1 / (v + 1);
  const auto slab = scatter(volume, self());
  const auto sum = [&] {
    return sum_rows(slab, self(), [&](std::int64_t j, std::int64_t k) {
      double row = 0;
      for (std::int64_t i = 0; i < 31; ++i) row += slab.row(j, k)[i];
      return row;
    });
  };
  set_thread_count(1);
  const double one = sum();
  set_thread_count(3);
  EXPECT_EQ(sum(), one);
  EXPECT_NEAR(one, 8.45, 0.05);  // harmonic number of 2635
}

}  // namespace
}  // namespace heartgen::parallel
