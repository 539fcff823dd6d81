// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/improve_kept.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generator/tetmesh/quality.hpp"
#include "mesh/labelled_cube.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

// A repeatable number in [-1, 1] for a node and an axis.
double wobble(std::size_t node, int axis) { return std::sin(12.9898 * static_cast<double>(node) + 78.233 * axis); }

double worst_of(const LabelledCells& mesh) {
  double worst = 1;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (mesh.label[c] == 0) continue;
    const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(mesh.cells[c][i])]; };
    worst = std::min(worst, tetmesh::cell_quality(at(0), at(1), at(2), at(3)));
  }
  return worst;
}

TEST(ImproveKept, ShakenMeshGetsBetterAndKeepsItsInterfaces) {
  auto mesh = cube(8, 4);
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    auto& p = mesh.nodes_mm[n];
    const bool inside = p.x > 1 && p.x < 7 && p.y > 1 && p.y < 7 && p.z > 1 && p.z < 7 && p.z != 4;
    for (int axis = 0; inside && axis < 3; ++axis) p[axis] += 0.2 * wobble(n, axis);
  }
  const auto faces = interface_faces(mesh);
  const double before = worst_of(mesh), lower = volume_of(mesh, 1), upper = volume_of(mesh, 2);
  ASSERT_GT(before, 0);
  ASSERT_LT(before, 0.15);
  mesh::improve_kept(mesh, 3);
  EXPECT_GT(worst_of(mesh), std::sin(15 * std::acos(-1.0) / 180));
  EXPECT_EQ(interface_faces(mesh), faces);
  EXPECT_NEAR(volume_of(mesh, 1), lower, 1e-9);
  EXPECT_NEAR(volume_of(mesh, 2), upper, 1e-9);
  EXPECT_TRUE(std::is_sorted(mesh.cells.begin(), mesh.cells.end()));
}

TEST(ImproveKept, GoodMeshIsLeftAlone) {
  auto mesh = cube(5, 2);
  const auto nodes = mesh.nodes_mm;
  mesh::improve_kept(mesh, 3);
  EXPECT_EQ(mesh.nodes_mm, nodes);
}

}  // namespace
