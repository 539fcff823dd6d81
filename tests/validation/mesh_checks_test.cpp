// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/mesh_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/labels.hpp"
#include "support/diced_cubes.hpp"
#include "validation/cell_quality.hpp"
#include "validation/mesh_topology.hpp"

namespace {

using namespace heartgen;

const ReportRow& row(const Report& report, const std::string& scope, const std::string& metric) {
  const auto found = std::find_if(report.begin(), report.end(),
                                  [&](const ReportRow& r) { return r.scope == scope && r.metric == metric; });
  if (found == report.end()) throw std::runtime_error("no row " + scope + " " + metric);
  return *found;
}

double value(const Report& report, const std::string& metric) { return row(report, "mesh", metric).value; }

Report check(const TetMesh& mesh) { return validation::check_mesh("mesh", mesh, ValidationSettings{}); }

// Every boundary and interface face, labelled, found without the code under test.
void list_faces(TetMesh& mesh) {
  mesh.faces.clear();
  const auto cells_with = [&](const Face& face) {
    std::vector<std::size_t> cells;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      if (std::all_of(face.begin(), face.end(), [&](std::int32_t n) {
            return std::find(mesh.cells[c].begin(), mesh.cells[c].end(), n) != mesh.cells[c].end();
          }))
        cells.push_back(c);
    return cells;
  };
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto& n = mesh.cells[c];
    for (const Face& face : {Face{n[1], n[2], n[3]}, {n[0], n[3], n[2]}, {n[0], n[1], n[3]}, {n[0], n[2], n[1]}}) {
      const auto cells = cells_with(face);
      if (cells.size() == 1 || (cells[0] == c && mesh.region[cells[0]] != mesh.region[cells[1]]))
        mesh.faces.push_back(face);
    }
  }
  mesh.surface.assign(mesh.faces.size(), *surface_from_name("epicardium"));
}

TetMesh regular() {
  TetMesh mesh;
  mesh.nodes_mm = {{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(3) / 2, 0}, {0.5, std::sqrt(3) / 6, std::sqrt(2.0 / 3)}};
  mesh.cells = {{0, 1, 2, 3}};
  mesh.region = {1};
  list_faces(mesh);
  return mesh;
}

TetMesh cube(int n) {
  TetMesh mesh;
  mesh.nodes_mm = heartgen::testing::cube_corners(n);
  heartgen::testing::dice_cubes(n, [&](const Cell& cell, int, int, int) { mesh.cells.push_back(cell); });
  mesh.region.assign(mesh.cells.size(), 1);
  list_faces(mesh);
  return mesh;
}

TEST(CellQuality, RegularCellIsPerfect) {
  const auto report = check(regular());
  const double angle = std::acos(1.0 / 3) * 180 / std::acos(-1.0);
  EXPECT_NEAR(value(report, "dihedral_min"), angle, 1e-9);
  EXPECT_NEAR(value(report, "dihedral_max"), angle, 1e-9);
  EXPECT_NEAR(value(report, "radius_ratio_min"), 1, 1e-12);
  EXPECT_NEAR(value(report, "scaled_jacobian_min"), 1, 1e-12);
  EXPECT_NEAR(value(report, "edge_min"), 1, 1e-12);
  EXPECT_NEAR(value(report, "edge_max"), 1, 1e-12);
  EXPECT_NEAR(value(report, "volume"), std::sqrt(2) / 12 / 1000, 1e-12);
  EXPECT_TRUE(all_passed(report));
}

TEST(CellQuality, CornerOfACube) {
  const auto q = validation::cell_quality({Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  EXPECT_NEAR(q.max_dihedral_deg, 90, 1e-9);
  EXPECT_NEAR(q.min_dihedral_deg, std::acos(1 / std::sqrt(3)) * 180 / std::acos(-1.0), 1e-9);
  EXPECT_NEAR(q.volume_mm3, 1.0 / 6, 1e-15);
  const double inradius = 1 / (3 + std::sqrt(3)), circumradius = std::sqrt(3) / 2;
  EXPECT_NEAR(q.radius_ratio, 3 * inradius / circumradius, 1e-12);
  EXPECT_NEAR(q.scaled_jacobian, std::sqrt(2) / 2, 1e-12) << "worst at the corners with edges 1, sqrt 2, sqrt 2";
}

TEST(CellQuality, FlatAndInvertedCells) {
  const auto flat = validation::cell_quality({Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}});
  EXPECT_EQ(flat.radius_ratio, 0);
  EXPECT_NEAR(flat.min_dihedral_deg, 0, 1e-9);
  EXPECT_NEAR(flat.max_dihedral_deg, 180, 1e-9);
  const auto inverted = validation::cell_quality({Vec3{0, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}});
  EXPECT_LT(inverted.volume_mm3, 0);
  EXPECT_LT(inverted.scaled_jacobian, 0);
}

TEST(FaceQuality, AgainstAHandCalculation) {
  const std::array<Vec3, 3> face{Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{0, 3, 0}};
  const auto straight = validation::face_quality(face, {1, 1, -1}, {1, 1, 2});
  EXPECT_NEAR(straight.non_orthogonality_deg, 0, 1e-9);
  EXPECT_NEAR(straight.skewness, 0, 1e-12);
  const auto tilted = validation::face_quality(face, {1, 1, -1}, {3, 1, 1});  // crosses the face at (2, 1, 0)
  EXPECT_NEAR(tilted.non_orthogonality_deg, 45, 1e-9);
  EXPECT_NEAR(tilted.skewness, 0.5, 1e-12) << "1 mm off, where the face reaches 2 mm";
  EXPECT_NEAR(validation::boundary_skewness(face, {1, 1, -1}), 0, 1e-12);
  EXPECT_NEAR(validation::boundary_skewness(face, {2, 1, -1}), 0.5, 1e-12);
}

TEST(MeshChecks, CubeIsValid) {
  const auto mesh = cube(3);
  const auto report = check(mesh);
  EXPECT_TRUE(all_passed(report));
  EXPECT_NEAR(value(report, "dihedral_min"), 45, 1e-9);
  EXPECT_NEAR(value(report, "dihedral_max"), 90, 1e-9);
  EXPECT_NEAR(value(report, "volume"), 27.0 / 1000, 1e-12);
  EXPECT_EQ(value(report, "cells"), 162);
  EXPECT_EQ(value(report, "faces"), 108);
  EXPECT_EQ(value(report, "components"), 1);
  EXPECT_EQ(value(report, "boundary_euler_characteristic"), 2);
  EXPECT_NEAR(row(report, "mesh/epicardium", "area").value, 54.0 / 100, 1e-12);
  EXPECT_EQ(row(report, "mesh/lv_myocardium", "cells").value, 162);
}

TEST(MeshChecks, InvertedCellIsFound) {
  auto mesh = cube(2);
  std::swap(mesh.cells[7][0], mesh.cells[7][1]);
  const auto report = check(mesh);
  EXPECT_EQ(value(report, "inverted_cells"), 1);
  EXPECT_FALSE(row(report, "mesh", "inverted_cells").passed());
  EXPECT_LT(value(report, "scaled_jacobian_min"), 0);
}

TEST(MeshChecks, DuplicatedNodeTearsTheMesh) {
  auto mesh = cube(2);
  mesh.nodes_mm.push_back(mesh.nodes_mm[13]);  // the middle
  mesh.cells[0][3] = mesh.cells[0][3] == 13 ? 27 : mesh.cells[0][3];
  ASSERT_EQ(mesh.cells[0][3], 27) << "the first cell ends in the middle node";
  const auto report = check(mesh);
  EXPECT_EQ(value(report, "duplicate_nodes"), 1);
  EXPECT_GT(value(report, "boundary_faces_missing"), 0) << "the tear is a boundary";
  EXPECT_FALSE(all_passed(report));
}

TEST(MeshChecks, OrphanNodeAndRepeatedCell) {
  auto mesh = cube(1);
  mesh.nodes_mm.push_back({9, 9, 9});
  mesh.cells.push_back(mesh.cells[0]);
  mesh.region.push_back(1);
  const auto report = check(mesh);
  EXPECT_EQ(value(report, "orphan_nodes"), 1);
  EXPECT_EQ(value(report, "duplicate_cells"), 1);
  EXPECT_GT(value(report, "faces_of_more_than_two_cells"), 0);
}

TEST(MeshChecks, TwoCellsOnOneEdgeAreNotManifold) {
  TetMesh mesh;
  mesh.nodes_mm = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  mesh.cells = {{0, 2, 3, 1}, {0, 4, 5, 1}};
  mesh.region = {1, 1};
  list_faces(mesh);
  const auto report = check(mesh);
  EXPECT_EQ(value(report, "inverted_cells"), 0);
  EXPECT_EQ(value(report, "boundary_non_manifold_edges"), 1);
  EXPECT_EQ(value(report, "components"), 2);
  EXPECT_FALSE(row(report, "mesh", "boundary_non_manifold_edges").passed());
}

TEST(MeshChecks, TwoCellsOnOneVertexAreNotManifold) {
  TetMesh mesh;
  mesh.nodes_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  mesh.cells = {{0, 1, 2, 3}, {0, 5, 4, 6}};
  mesh.region = {1, 1};
  list_faces(mesh);
  const auto report = check(mesh);
  EXPECT_EQ(value(report, "boundary_non_manifold_edges"), 0);
  EXPECT_EQ(value(report, "boundary_non_manifold_vertices"), 1);
}

TEST(MeshChecks, EveryWayAFaceListCanBeWrong) {
  const auto good = cube(2);
  auto missing = good;
  missing.faces.pop_back();
  missing.surface.pop_back();
  EXPECT_EQ(value(check(missing), "boundary_faces_missing"), 1);

  auto repeated = good;
  repeated.faces.push_back({good.faces[0][1], good.faces[0][2], good.faces[0][0]});
  repeated.surface.push_back(2);
  EXPECT_EQ(value(check(repeated), "faces_repeated"), 1);

  auto unlabelled = good;
  unlabelled.surface[3] = 0;
  EXPECT_EQ(value(check(unlabelled), "faces_unlabelled"), 1);

  auto foreign = good;
  foreign.faces.push_back({0, 13, 26});  // a diagonal of the cube is no face
  foreign.surface.push_back(1);
  EXPECT_EQ(value(check(foreign), "faces_without_cells"), 1);

  auto inside = good;
  inside.faces.push_back({good.cells[0][0], good.cells[0][1], good.cells[0][3]});
  inside.surface.push_back(1);
  const auto report = check(inside);
  EXPECT_EQ(value(report, "faces_inside_regions") + value(report, "faces_repeated"), 1);

  auto interface = good;
  for (std::size_t c = 0; c < 6; ++c) interface.region[c] = 2;  // one corner cube: 6 of its 12 faces are inside
  EXPECT_EQ(value(check(interface), "interface_faces_missing"), 6);
  list_faces(interface);
  EXPECT_EQ(value(check(interface), "interface_faces_missing"), 0);
  EXPECT_TRUE(all_passed(check(interface)));
}

TEST(MeshChecks, TorusHasEulerCharacteristicZero) {
  auto mesh = cube(3);
  TetMesh ring = mesh;
  ring.cells.clear();
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto block = c / 6;  // i fastest, then j, k: leave out the column through the middle
    if (block % 9 != 4) ring.cells.push_back(mesh.cells[c]);
  }
  ring.region.assign(ring.cells.size(), 1);
  list_faces(ring);
  const auto report = check(ring);
  EXPECT_TRUE(all_passed(report));
  EXPECT_EQ(value(report, "boundary_euler_characteristic"), 0);
}

TEST(MeshChecks, BadAngleIsReportedWhereItIs) {
  auto mesh = cube(2);
  for (std::size_t c = 24; c < mesh.cells.size(); ++c) mesh.region[c] = 6;  // the upper half
  list_faces(mesh);
  mesh.nodes_mm[26].z = 1.01;  // the top corner, pressed down: flat cells in the upper half only
  const auto report = check(mesh);
  EXPECT_LT(row(report, "mesh/lv_blood", "dihedral_min").value, 5);
  EXPECT_FALSE(row(report, "mesh/lv_blood", "dihedral_min").passed());
  EXPECT_TRUE(row(report, "mesh/lv_myocardium", "dihedral_min").passed());
  EXPECT_FALSE(row(report, "mesh", "dihedral_min").passed());
}

TEST(MeshChecks, NodeIdsOutOfRangeEndTheCheck) {
  auto mesh = cube(1);
  mesh.cells[2][1] = 99;
  const auto report = check(mesh);
  EXPECT_EQ(value(report, "invalid_ids"), 1);
  EXPECT_FALSE(all_passed(report));
  EXPECT_EQ(report.back().metric, "invalid_ids");
}

TEST(MeshChecks, APartThatSharesNoNodeFloats) {
  auto mesh = cube(3);
  EXPECT_EQ(value(check(mesh), "floating_parts"), 0);
  const auto cell = mesh.cells.front();
  Cell copy = cell;
  for (auto& n : copy) {
    mesh.nodes_mm.push_back(mesh.nodes_mm[static_cast<std::size_t>(n)] + Vec3{9, 0, 0});
    n = static_cast<std::int32_t>(mesh.nodes_mm.size()) - 1;
  }
  mesh.cells.push_back(copy);
  mesh.region.push_back(1);
  list_faces(mesh);
  const auto report = check(mesh);
  EXPECT_EQ(value(report, "parts"), 2);
  EXPECT_EQ(value(report, "floating_parts"), 1);
  EXPECT_FALSE(row(report, "mesh", "floating_parts").passed());
}

TEST(MeshChecks, CellsWithAllNodesOnOneSurfaceAreLocked) {
  const auto corner = cube(1);  // every node is on the surface
  EXPECT_EQ(row(check(corner), "mesh/epicardium", "locked_cells").value, 6);
  EXPECT_EQ(row(check(corner), "mesh/epicardium", "locked_cell_share").value, 1);
}

TEST(MeshChecks, EmptyMeshFails) { EXPECT_FALSE(all_passed(check(TetMesh{}))); }

}  // namespace
