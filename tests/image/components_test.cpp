// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/components.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "generator/image/morphology.hpp"

namespace heartgen::image {
namespace {

Mask noise_mask(std::uint32_t seed) {
  Grid grid;
  grid.size = {23, 17, 9};
  Mask mask(grid);
  for (auto& v : mask.voxels) {
    seed = seed * 1664525U + 1013904223U;
    v = (seed >> 16U) % 100 < 35;
  }
  return mask;
}

/// Flood fill, one voxel at a time.
Mask slow_component(const Mask& mask, Index3 seed) {
  Mask found(mask.grid);
  if (!mask(seed[0], seed[1], seed[2])) return found;
  std::vector<Index3> stack{seed};
  found(seed[0], seed[1], seed[2]) = 1;
  while (!stack.empty()) {
    const Index3 at = stack.back();
    stack.pop_back();
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const std::int64_t step : {-1, 1}) {
        Index3 to = at;
        to[axis] += step;
        if (!mask.grid.contains(to[0], to[1], to[2]) || !mask(to[0], to[1], to[2]) || found(to[0], to[1], to[2]))
          continue;
        found(to[0], to[1], to[2]) = 1;
        stack.push_back(to);
      }
  }
  return found;
}

TEST(Components, SeedsComponentEqualsFloodFill) {
  const Mask mask = noise_mask(7);
  for (std::int64_t n = 0; n < 60; ++n) {
    const Index3 seed{n * 5 % 23, n * 3 % 17, n % 9};
    EXPECT_EQ(image::component_of(mask, seed).voxels, slow_component(mask, seed).voxels);
  }
}

TEST(Components, LabelsAreNumberedInMemoryOrderAndCounted) {
  const image::Components all = image::connected_components(noise_mask(3));
  std::vector<std::int64_t> counted(all.voxel_count.size(), 0);
  std::int32_t largest = 0;
  for (const auto label : all.label.voxels) {
    EXPECT_LE(label, largest + 1);
    largest = std::max(largest, label);
    ++counted[static_cast<std::size_t>(label)];
  }
  EXPECT_EQ(counted, all.voxel_count);
}

TEST(Components, SizeLimitRefusesALeak) {
  const Mask mask = image::largest_component(noise_mask(11));
  const auto size = image::count(mask);
  std::int64_t v = 0;
  while (!mask.voxels[static_cast<std::size_t>(v)]) ++v;
  const Index3 seed{v % 23, v / 23 % 17, v / (23 * 17)};
  EXPECT_EQ(image::count(image::component_of(mask, seed, size)), size);
  EXPECT_EQ(image::count(image::component_of(mask, seed, size - 1)), 0);
}

TEST(Components, SmallOnesAreDropped) {
  const Mask mask = noise_mask(13);
  const image::Components all = image::connected_components(mask);
  std::int64_t expected = 0;
  for (std::size_t n = 1; n < all.voxel_count.size(); ++n)
    if (all.voxel_count[n] >= 5) expected += all.voxel_count[n];
  EXPECT_EQ(image::count(image::drop_small_components(mask, 5)), expected);
}

TEST(Components, HolesAreFilledInSpaceAndInSlices) {
  Grid grid;
  grid.size = {7, 7, 7};
  Mask shell(grid, 1);
  shell(3, 3, 3) = 0;
  EXPECT_EQ(image::count(image::fill_holes(shell)), 343);
  for (std::int64_t k = 0; k < 7; ++k) shell(3, 3, k) = 0;  // a tunnel: open in space, closed in every slice
  EXPECT_EQ(image::count(image::fill_holes(shell)), 336);
  EXPECT_EQ(image::count(image::fill_holes_in_slices(shell)), 343);
}

}  // namespace
}  // namespace heartgen::image
