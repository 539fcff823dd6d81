// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generator/parallel/threads.hpp"
#include "support/places.hpp"

namespace heartgen::image {
namespace {

using testing::lps_of_voxel;

Mask scattered(std::uint32_t seed, std::uint32_t one_in) {
  Grid grid;
  grid.size = {19, 14, 11};
  grid.spacing_mm = {0.7, 1.3, 2.5};
  Mask mask(grid);
  for (auto& v : mask.voxels) {
    seed = seed * 1664525U + 1013904223U;
    v = (seed >> 16U) % one_in == 0;
  }
  return mask;
}

double slow_distance(const Mask& mask, std::int64_t v) {
  double best = 1e6;
  for (std::int64_t u = 0; u < mask.grid.voxel_count(); ++u)
    if (mask.voxels[static_cast<std::size_t>(u)])
      best = std::min(best, norm(lps_of_voxel(mask.grid, u) - lps_of_voxel(mask.grid, v)));
  return best;
}

TEST(Distance, EqualsTheSlowSearch) {
  for (const std::uint32_t one_in : {3U, 40U, 900U}) {
    const Mask mask = scattered(one_in, one_in);
    const auto distance = image::distance_to(mask);
    for (std::int64_t v = 0; v < mask.grid.voxel_count(); v += 7)
      EXPECT_NEAR(static_cast<double>(distance.voxels[static_cast<std::size_t>(v)]), slow_distance(mask, v), 1e-4);
  }
}

/// Inside what is set nothing is sought; around it and in its gaps it is.
TEST(Distance, OfSolidMasksEqualsTheSlowSearch) {
  Mask mask = scattered(5, 900);
  for (std::int64_t k = 2; k < 9; ++k)
    for (std::int64_t j = 0; j < 10; ++j)
      for (std::int64_t i = 4; i < 15; ++i) mask(i, j, k) = i != 9 && j != 5;
  const auto distance = image::distance_to(mask);
  for (std::int64_t v = 0; v < mask.grid.voxel_count(); ++v)
    ASSERT_NEAR(static_cast<double>(distance.voxels[static_cast<std::size_t>(v)]), slow_distance(mask, v), 1e-4) << v;
}

TEST(Distance, OfTheNearestLabelIsThatOfItsMask) {
  LabelVolume labels = scattered(7, 60);
  std::uint8_t next = 1;
  for (auto& label : labels.voxels)
    if (label) label = next = static_cast<std::uint8_t>(next % 5 + 1);
  const image::NearestLabel nearest = image::nearest_label_and_distance(labels);
  EXPECT_EQ(nearest.label.voxels, image::nearest_label(labels, 1e9).voxels);
  EXPECT_EQ(nearest.distance_mm.voxels, image::distance_to(labels).voxels);
  const image::NearestLabel none = image::nearest_label_and_distance(LabelVolume(labels.grid));
  EXPECT_EQ(none.label.voxels, LabelVolume(labels.grid).voxels);
  for (const float distance : none.distance_mm.voxels) EXPECT_EQ(distance, 1e6F);
}

TEST(Distance, EmptyMaskIsFarEverywhere) {
  Mask mask = scattered(1, 2);
  std::fill(mask.voxels.begin(), mask.voxels.end(), std::uint8_t{0});
  for (const float d : image::distance_to(mask, 50).voxels) EXPECT_EQ(d, 50);
}

TEST(Distance, SameBitsForAnyNumberOfThreads) {
  const Mask mask = scattered(5, 60);
  const int threads = parallel::thread_count();
  parallel::set_thread_count(1);
  const auto one = image::distance_to(mask);
  parallel::set_thread_count(3);
  const auto three = image::distance_to(mask);
  parallel::set_thread_count(threads);
  EXPECT_EQ(one.voxels, three.voxels);
}

TEST(Distance, SignedDistanceIsZeroHalfWayBetweenVoxels) {
  Grid grid;
  grid.size = {12, 5, 4};
  grid.spacing_mm = {1.5, 0.8, 3};
  Mask mask(grid);
  for (std::int64_t k = 0; k < 4; ++k)
    for (std::int64_t j = 0; j < 5; ++j)
      for (std::int64_t i = 0; i < 6; ++i) mask(i, j, k) = 1;
  const auto phi = image::signed_distance(mask);
  EXPECT_FLOAT_EQ(phi(5, 2, 2), -phi(6, 2, 2));
  EXPECT_LT(phi(5, 2, 2), 0);
  EXPECT_NEAR(phi(8, 2, 2) - phi(7, 2, 2), 1.5, 1e-5);
}

TEST(Distance, NearestLabelIsTheNearestVoxelsLabel) {
  LabelVolume labels = scattered(9, 200);
  std::uint8_t next = 1;
  for (auto& v : labels.voxels)
    if (v) v = next++;
  const auto nearest = image::nearest_label(labels, 4);
  const auto distance = image::distance_to(labels);
  for (std::int64_t v = 0; v < labels.grid.voxel_count(); ++v) {
    const auto at = static_cast<std::size_t>(v);
    if (distance.voxels[at] > 4) {
      EXPECT_EQ(nearest.voxels[at], 0);
      continue;
    }
    const auto owner = std::find(labels.voxels.begin(), labels.voxels.end(), nearest.voxels[at]);
    EXPECT_NEAR(norm(lps_of_voxel(labels.grid, owner - labels.voxels.begin()) - lps_of_voxel(labels.grid, v)),
                static_cast<double>(distance.voxels[at]), 1e-4);
  }
}

}  // namespace
}  // namespace heartgen::image
