// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mesh_queries/voxels_in_cell.hpp"

#include <gtest/gtest.h>

#include <map>

namespace heartgen {
namespace {

Grid turned_grid() {
  Grid grid;
  grid.size = {9, 8, 7};
  grid.spacing_mm = {0.7, 0.9, 1.3};
  grid.origin_mm = {4, -3, 2};
  grid.direction = {{Vec3{0.6, -0.8, 0}, Vec3{0.8, 0.6, 0}, Vec3{0, 0, -1}}};
  return grid;
}

TEST(VoxelsInCell, AreThoseThatTheFourPlanesLeaveAndWeightsGiveTheirPlaces) {
  const Grid grid = turned_grid();
  const std::array<Vec3, 4> p = {lps_from_index(grid, {-2.1, 0.3, 0.2}), lps_from_index(grid, {9.4, 1.1, 0.9}),
                                 lps_from_index(grid, {3.2, 9.7, 1.8}), lps_from_index(grid, {4.1, 3.3, 8.6})};
  std::map<std::int64_t, std::array<double, 4>> found;
  mesh_queries::for_voxels_in_cell(grid, p, [&](std::int64_t voxel, const auto& weights) { found[voxel] = weights; });
  EXPECT_GT(found.size(), 50u);
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return dot(b - a, cross(c - a, d - a));
  };
  const double whole = volume(p[0], p[1], p[2], p[3]);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const Vec3 x = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        const std::array<double, 4> parts = {volume(x, p[1], p[2], p[3]) / whole, volume(p[0], x, p[2], p[3]) / whole,
                                             volume(p[0], p[1], x, p[3]) / whole, volume(p[0], p[1], p[2], x) / whole};
        const auto at = found.find(grid.offset(i, j, k));
        ASSERT_EQ(at != found.end(), *std::min_element(parts.begin(), parts.end()) >= 0);
        for (std::size_t n = 0; at != found.end() && n < 4; ++n) EXPECT_NEAR(at->second[n], parts[n], 1e-9);
      }
}

TEST(VoxelsInCell, AreNoneInAFlatCellOrBesideTheGrid) {
  const Grid grid = turned_grid();
  const auto none = [](std::int64_t, const auto&) { FAIL(); };
  const auto at = [&](double i, double j, double k) { return lps_from_index(grid, {i, j, k}); };
  mesh_queries::for_voxels_in_cell(grid, {at(0, 0, 0), at(5, 0, 0), at(0, 5, 0), at(5, 5, 0)}, none);
  mesh_queries::for_voxels_in_cell(grid, {at(20, 0, 0), at(25, 0, 0), at(20, 5, 0), at(20, 0, 5)}, none);
}

}  // namespace
}  // namespace heartgen
