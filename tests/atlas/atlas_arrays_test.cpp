// SPDX-License-Identifier: GPL-3.0-or-later
// Which array of a file is the atlas's fibres, and where values per cell hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generator/adapters/vtk_io.hpp"
#include "generator/atlas/atlas.hpp"
#include "generator/atlas/point_axes.hpp"
#include "generator/mesh_files/msh_file.hpp"
#include "support/data.hpp"
#include "support/diced_cubes.hpp"
#include "support/files.hpp"

namespace heartgen {
namespace {

const std::vector<Vec3> along_x(4, {1, 0, 0}), along_y(4, {0, 1, 0}), along_z(4, {0, 0, 1});

UnstructuredData one_cell() {
  UnstructuredData data;
  data.points = {{0, 0, 0}, {80, 0, 0}, {0, 80, 0}, {0, 0, 80}};
  data.tets = {{0, 1, 2, 3}};
  return data;
}

/// What is read from a file with these arrays, or why nothing is.
FiberAtlas read(const UnstructuredData& data, const std::string& array = {}) {
  const auto path = testing::scratch_folder("atlas_arrays") / "atlas.vtu";
  adapters::write_unstructured(path, data);
  return atlas::read_fiber_atlas(path.string(), array);
}

TEST(AtlasArrays, AKnownNameGoesBeforeTheAlphabet) {
  auto data = one_cell();
  data.point_vectors = {{"Normals", along_x}, {"f0", along_y}, {"s0", along_z}};
  const auto atlas = read(data);
  EXPECT_EQ(atlas.fiber, along_y);
  EXPECT_EQ(atlas.array, "point array \"f0\"");
}

TEST(AtlasArrays, AKnownNameGoesBeforeThePlace) {
  auto data = one_cell();
  data.point_vectors = {{"Normals", along_x}};
  data.cell_vectors = {{"fiber", {{0, 1, 0}}}};
  const auto atlas = read(data);
  EXPECT_EQ(atlas.array, "cell array \"fiber\"");
  for (const auto& f : atlas.fiber) EXPECT_NEAR(std::abs(f.y), 1, 1e-12);
  data.point_vectors["FIB_DIR"] = along_z;
  EXPECT_EQ(read(data).array, "point array \"FIB_DIR\"") << "of two known names the one on points";
}

TEST(AtlasArrays, WithoutAKnownNameAllAreListedAndOneCanBeNamed) {
  auto data = one_cell();
  data.point_vectors = {{"Normals", along_x}, {"direction", along_y}};
  data.cell_tensors = {{"diffusion", {Mat3{}}}};
  const auto refusal = testing::error_of([&] { read(data); });
  for (const char* part : {"point array \"Normals\"", "point array \"direction\"", "cell array \"diffusion\"",
                           "--atlas-array", "input.atlas_array"})
    EXPECT_NE(refusal.find(part), std::string::npos) << refusal;
  EXPECT_EQ(read(data, "direction").fiber, along_y);
  EXPECT_EQ(read(data, "Normals").fiber, along_x) << "whoever names it wants it";
  EXPECT_NE(testing::error_of([&] { read(data, "f0"); }).find("has no array \"f0\""), std::string::npos);
  data.cell_tensors.clear();
  data.point_vectors.erase("direction");
  EXPECT_NE(testing::error_of([&] { read(data); }).find("Normals"), std::string::npos) << "normals are no fibres";
  data.point_vectors = {{"direction", along_y}};
  EXPECT_EQ(read(data).array, "point array \"direction\"") << "the only one there is";
}

TEST(AtlasArrays, AGmshFileIsReadToo) {
  auto data = one_cell();
  data.cell_vectors = {{"fiber", {{0, 0, 2}}}};
  const auto path = testing::scratch_folder("atlas_msh") / "atlas.msh";
  mesh_files::write_msh(path, data, "");
  const auto atlas = atlas::read_fiber_atlas(path.string());
  EXPECT_EQ(atlas.array, "cell array \"fiber\"");
  for (const auto& f : atlas.fiber) EXPECT_NEAR(std::abs(f.z), 1, 1e-12);
}

/// A wall from x = 0 to x = 4 edges in which the helix turns by 120 degrees.
struct Wall {
  std::vector<Vec3> points = testing::cube_corners(4);
  std::vector<Cell> cells{};
  std::vector<Vec3> cell_axes{};

  static Vec3 axis_at(double x) {
    const double angle = (60 - 30 * x) * std::acos(-1.0) / 180;
    return {0, std::cos(angle), std::sin(angle)};
  }
  Wall() {
    testing::dice_cubes(4, [&](const Cell& cell, int, int, int) {
      double x = 0;
      for (const auto n : cell) x += 0.25 * points[static_cast<std::size_t>(n)].x;
      cells.push_back(cell);
      cell_axes.push_back((cells.size() % 2 == 0 ? -3.0 : 1.0) * axis_at(x));
    });
  }
  /// Mean error at the points of one depth.
  double error_deg(const std::vector<Vec3>& axes, double x) const {
    double sum = 0, count = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (points[p].x != x) continue;
      sum += std::acos(std::min(1.0, std::abs(dot(axes[p], axis_at(x))))) * 180 / std::acos(-1.0);
      ++count;
    }
    return sum / count;
  }
};

TEST(PointAxes, OfCellsAreExtrapolatedToTheWalls) {
  const Wall wall;
  const auto means = atlas::mean_point_axes(wall.points.size(), wall.cells, wall.cell_axes);
  const auto fitted = atlas::point_axes(wall.points, wall.cells, wall.cell_axes);
  for (const double x : {0.0, 4.0}) {
    EXPECT_GT(wall.error_deg(means, x), 10) << "means lie half a cell deep";
    EXPECT_LT(wall.error_deg(fitted, x), 1);
  }
  EXPECT_LT(wall.error_deg(fitted, 2), 0.7);
  for (const auto& axis : fitted) EXPECT_NEAR(norm(axis), 1, 1e-12);
}

TEST(PointAxes, InAWallOneCellThickToo) {
  Wall wall;
  const auto half = wall;
  wall.cells.clear();
  wall.cell_axes.clear();
  for (std::size_t c = 0; c < half.cells.size(); ++c) {
    const auto& cell = half.cells[c];
    if (std::any_of(cell.begin(), cell.end(), [&](auto n) { return half.points[static_cast<std::size_t>(n)].x > 1; }))
      continue;
    wall.cells.push_back(cell);
    wall.cell_axes.push_back(half.cell_axes[c]);
  }
  const auto means = atlas::mean_point_axes(wall.points.size(), wall.cells, wall.cell_axes);
  const auto axes = atlas::point_axes(wall.points, wall.cells, wall.cell_axes);
  for (const double x : {0.0, 1.0}) {
    EXPECT_GT(wall.error_deg(means, x), 10);
    EXPECT_LT(wall.error_deg(axes, x), 2);
  }
}

TEST(PointAxes, CellsWithoutAnAxisCountForNothing) {
  Wall wall;
  for (auto& axis : wall.cell_axes) axis = {};
  for (const auto& axis : atlas::point_axes(wall.points, wall.cells, wall.cell_axes)) EXPECT_EQ(axis, Vec3{});
  wall.cell_axes[0] = {0, 0, 5};
  const auto axes = atlas::point_axes(wall.points, wall.cells, wall.cell_axes);
  EXPECT_EQ(axes[static_cast<std::size_t>(wall.cells[0][0])], (Vec3{0, 0, 1}));
}

}  // namespace
}  // namespace heartgen
