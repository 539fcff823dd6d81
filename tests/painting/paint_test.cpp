// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/painting/paint.hpp"

#include <gtest/gtest.h>

#include "generator/adapters/itk_io.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "support/files.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen::painting {
namespace {

constexpr int cubes = 14;  // the block is 30.8 x 14 x 12.6 mm, its first half muscle
const Vec3 middle{8, -0.5, 6};

Grid grid_of(double voxel_mm) {
  Grid grid;
  grid.spacing_mm = {voxel_mm, voxel_mm, 1.25 * voxel_mm};
  grid.size = {static_cast<std::int64_t>(36 / voxel_mm), static_cast<std::int64_t>(20 / voxel_mm),
               static_cast<std::int64_t>(16 / voxel_mm)};
  grid.origin_mm = {-2.1, -9.3, -2.2};
  return grid;
}

/// The voxels whose distance from a point lies between two radii.
Mask shell(const Grid& grid, const Vec3& center, double from_mm, double to_mm) {
  Mask mask(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const double r = norm(
            lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}) - center);
        mask(i, j, k) = r >= from_mm && r < to_mm;
      }
  return mask;
}

double tagged_mm3(const TetMesh& mesh, std::int32_t tag) {
  double volume = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.user_region[c] == tag) volume += cell_volume_mm3(mesh, mesh.cells[c]);
  return volume;
}

bool takes_all(std::int32_t /*region*/) { return true; }

class PaintAt : public ::testing::TestWithParam<double> {};

/// Voxels finer than the cells, and as coarse as late enhancement has them.
TEST_P(PaintAt, VolumesOfGreyZoneAndCoreAreKeptToTwoPerCent) {
  const Grid grid = grid_of(GetParam());
  TetMesh mesh = testing::two_region_mesh(cubes);
  const std::vector<RegionMask> regions{{"core", "", 0, shell(grid, middle, 0, 3.4)},
                                        {"grey_zone", "", 0, shell(grid, middle, 3.4, 5.1)}};
  paint(mesh, regions, takes_all);
  ASSERT_EQ(mesh.user_regions.size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    const double given = volume_mm3(regions[r].mask);
    EXPECT_NEAR(volume_mm3(mesh, mesh.user_regions[r]) / given, 1, 0.02) << regions[r].name;
    EXPECT_NEAR(tagged_mm3(mesh, mesh.user_regions[r].tag) / given, 1, 0.02) << regions[r].name;
  }
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    EXPECT_LE(mesh.user_regions[0].fraction[c] + mesh.user_regions[1].fraction[c], 1.0001F);
}

INSTANTIATE_TEST_SUITE_P(Voxels, PaintAt, ::testing::Values(0.3, 0.7, 1.4));

/// A disc thinner than a cell: whole cells cannot be as thin, but their volume can.
TEST(Paint, AThinLineKeepsItsVolume) {
  Grid grid = grid_of(0.25);
  RegionMask line{"line", "", 0, Mask(grid)};
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 30; j < 50; ++j)
      for (std::int64_t i = 40; i < 42; ++i) line.mask(i, j, k) = 1;
  TetMesh mesh = testing::two_region_mesh(cubes);
  paint(mesh, {line}, takes_all);
  const double held = volume_mm3(mesh, mesh.user_regions[0]);
  EXPECT_NEAR(tagged_mm3(mesh, first_user_region) / held, 1, 0.02);
  for (const float fraction : mesh.user_regions[0].fraction) EXPECT_LT(fraction, 0.9F);
}

TEST(Paint, OverlapCountsForTheFirstRegion) {
  const Grid grid = grid_of(0.5);
  TetMesh mesh = testing::two_region_mesh(cubes);
  paint(mesh, {{"core", "", 0, shell(grid, middle, 0, 3)}, {"scar", "", 0, shell(grid, middle, 0, 5)}}, takes_all);
  const double core = volume_mm3(mesh, mesh.user_regions[0]), scar = volume_mm3(mesh, mesh.user_regions[1]);
  EXPECT_NEAR(tagged_mm3(mesh, first_user_region) / core, 1, 0.02);
  EXPECT_NEAR(tagged_mm3(mesh, first_user_region + 1) / (scar - core), 1, 0.02);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    EXPECT_GE(mesh.user_regions[1].fraction[c], mesh.user_regions[0].fraction[c]);
}

TEST(Paint, OnlyTheCellsThatAreTaken) {
  const Vec3 interface { 1.0 / 3 + 1.1 * cubes, -0.5, 6 };
  TetMesh mesh = testing::two_region_mesh(cubes);
  paint(mesh, {{"scar", "", 0, shell(grid_of(0.4), interface, 0, 4)}},
        [](std::int32_t region) { return region == tag(Region::lv_myocardium); });
  double muscle = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (mesh.region[c] == tag(Region::lv_myocardium))
      muscle += mesh.user_regions[0].fraction[c];
    else
      EXPECT_EQ(mesh.user_regions[0].fraction[c], 0);
  }
  EXPECT_GT(muscle, 0);
}

TEST(Paint, ReachesTheLargerMeshByItsParentIds) {
  TetMesh whole = testing::two_region_mesh(4), part = whole;
  part.parent_cell.clear();
  part.cells.resize(part.cells.size() / 2);
  part.region.resize(part.cells.size());
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    part.cells[c] = whole.cells[2 * c + 1];
    part.parent_cell.push_back(static_cast<std::int32_t>(2 * c + 1));
  }
  paint(part, {{"scar", "", 0, shell(grid_of(0.5), {4, -5, 2}, 0, 2)}}, takes_all);
  carry_regions_to_parent(part, whole);
  for (std::size_t c = 0; c < part.cells.size(); ++c) {
    EXPECT_EQ(whole.user_region[2 * c], 0);
    EXPECT_EQ(whole.user_region[2 * c + 1], part.user_region[c]);
    EXPECT_EQ(whole.user_regions[0].fraction[2 * c + 1], part.user_regions[0].fraction[c]);
  }
}

TEST(Paint, ARegionElsewhereIsRefusedWithItsDistanceAndFrame) {
  LabelVolume labels(grid_of(1));
  labels.grid.origin_mm = {100, 50, 0};
  for (auto& voxel : labels.voxels) voxel = tag(Region::la_wall);
  const auto at = [&](const Vec3& origin) {
    RegionMask region{"scar", "lge.nii.gz", 0, Mask(grid_of(1))};
    region.mask.grid.size = {2, 2, 2};
    region.mask.voxels.assign(8, 1);
    region.mask.grid.origin_mm = origin;
    return testing::error_of([&] { refuse_regions_elsewhere({region}, walls_of(labels)); });
  };
  EXPECT_EQ(at({110, 60, 5}), "");
  const auto far = at({200, 60, 5});
  EXPECT_NE(far.find("lge.nii.gz"), std::string::npos);
  EXPECT_NE(far.find("mm away from the heart's walls"), std::string::npos) << far;
  EXPECT_NE(at({-111, -61, 5}).find("LPS, not in RAS"), std::string::npos);
  for (auto& voxel : labels.voxels) voxel = tag(Region::la_blood);
  labels.voxels.front() = labels.voxels.back() = tag(Region::la_wall);
  EXPECT_NE(at({110, 60, 5}).find("beside the heart's walls"), std::string::npos);
}

}  // namespace
}  // namespace heartgen::painting
