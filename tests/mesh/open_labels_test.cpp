// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/open_labels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/parallel/threads.hpp"
#include "mesh/shapes.hpp"
#include "support/places.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

constexpr std::array<std::uint8_t, 3> tags{tag(Region::lv_myocardium), tag(Region::rv_myocardium),
                                           tag(Region::ra_wall)};
constexpr double radius_mm = 1.5, half_angle_deg = 15;

bool is_block(const Vec3& p) { return std::abs(p.x) < 10 && std::abs(p.y) < 8 && std::abs(p.z) < 8; }

// A wedge of the right wall between two others, its edge at x = -6.
LabelVolume wedge() {
  const double slope = std::tan(half_angle_deg * 3.14159265 / 180);
  return label_cube(46, 0.5, [slope](const Vec3& p) {
    if (!is_block(p)) return Region::none;
    if (std::abs(p.y) < slope * (p.x + 6)) return Region::rv_myocardium;
    return p.y > 0 ? Region::lv_myocardium : Region::ra_wall;
  });
}

TEST(OpenLabels, AWedgeEndsAsWideAsTheBallAndItsNeighboursMeet) {
  const auto before = wedge();
  auto labels = before;
  mesh::open_labels(labels, tags, radius_mm);
  // A ball in the wedge reaches to here.
  const double end = -6 + radius_mm / std::sin(half_angle_deg * 3.14159265 / 180) - radius_mm;
  int gone = 0, kept = 0;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    const Vec3 p = heartgen::testing::lps_of_voxel(labels.grid, static_cast<std::int64_t>(v));
    if (std::abs(p.y) > 5 || std::abs(p.z) > 5) continue;  // corners of the block
    const auto was = before.voxels[v], is = labels.voxels[v];
    EXPECT_TRUE(is == was || was == tags[1]) << p.x << " " << p.y;
    if (was == tags[1] && p.x > end + 3 && p.x < 6) kept += is == was ? 1 : 100'000;
    if (was != tags[1] || p.x > end - 1 || std::abs(p.y) < 0.3) continue;
    ++gone;
    EXPECT_EQ(is, p.y > 0 ? tags[0] : tags[2]) << p.x << " " << p.y;
  }
  EXPECT_GT(gone, 30);
  EXPECT_GT(kept, 500);
  EXPECT_LT(kept, 100'000);
}

TEST(OpenLabels, ASkinOverAnotherLabelIsTheOthers) {
  auto labels = label_cube(46, 0.5, [](const Vec3& p) {
    if (!is_block(p)) return Region::none;
    return p.z > 7 ? Region::rv_myocardium : Region::lv_myocardium;
  });
  mesh::open_labels(labels, tags, radius_mm);
  EXPECT_EQ(std::count(labels.voxels.begin(), labels.voxels.end(), tags[1]), 0);
}

TEST(OpenLabels, AThinSheetWithoutNeighboursStaysAndSoDoesTheOutside) {
  const auto before = label_cube(46, 0.5, [](const Vec3& p) {
    if (std::abs(p.x) < 0.6 && std::abs(p.y) < 8) return Region::rv_myocardium;
    return p.x > 6 ? Region::lv_myocardium : Region::none;
  });
  auto labels = before;
  mesh::open_labels(labels, tags, radius_mm);
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    EXPECT_TRUE(labels.voxels[v] == before.voxels[v] || before.voxels[v] == tags[0]);
}

TEST(OpenLabels, ALabelThatIsNowhereChangesNothing) {
  const auto before =
      label_cube(46, 0.5, [](const Vec3& p) { return is_block(p) ? Region::lv_myocardium : Region::none; });
  auto labels = before;
  mesh::open_labels(labels, tags, radius_mm);
  EXPECT_EQ(labels.voxels, before.voxels);
}

TEST(OpenLabels, SameBitsForAnyNumberOfThreads) {
  const int threads = parallel::thread_count();
  auto first = wedge();
  parallel::set_thread_count(1);
  mesh::open_labels(first, tags, radius_mm);
  for (const int count : {2, 3}) {
    parallel::set_thread_count(count);
    auto labels = wedge();
    mesh::open_labels(labels, tags, radius_mm);
    EXPECT_EQ(labels.voxels, first.voxels);
  }
  parallel::set_thread_count(threads);
}

}  // namespace
