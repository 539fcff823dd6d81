// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/label_fidelity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "validation/region_topology.hpp"
#include "validation/self_intersection.hpp"

namespace {

using namespace heartgen;

/// Cells of six to each voxel where `inside` gives a region, on the voxels' own corners.
TetMesh mesh_of(const LabelVolume& labels) {
  TetMesh mesh;
  const auto& size = labels.grid.size;
  std::vector<std::int32_t> id(static_cast<std::size_t>((size[0] + 1) * (size[1] + 1) * (size[2] + 1)), -1);
  const auto corner = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    auto& n = id[static_cast<std::size_t>((k * (size[1] + 1) + j) * (size[0] + 1) + i)];
    if (n < 0) {
      n = static_cast<std::int32_t>(mesh.nodes_mm.size());
      mesh.nodes_mm.push_back(lps_from_index(
          labels.grid, {static_cast<double>(i) - 0.5, static_cast<double>(j) - 0.5, static_cast<double>(k) - 0.5}));
    }
    return n;
  };
  constexpr int paths[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        if (labels(i, j, k) == 0) continue;
        const auto at = [&](int bits) { return corner(i + (bits & 1), j + ((bits >> 1) & 1), k + (bits >> 2)); };
        for (const auto& path : paths) {
          mesh.cells.push_back({at(0), at(path[0]), at(path[1]), at(7)});
          mesh.region.push_back(labels(i, j, k));
        }
      }
  return mesh;
}

LabelVolume empty_map(std::int64_t n) {
  Grid grid;
  grid.size = {n, n, n};
  return LabelVolume(grid);
}

void fill(LabelVolume& labels, const Index3& low, const Index3& high, std::uint8_t value) {
  for (auto k = low[2]; k < high[2]; ++k)
    for (auto j = low[1]; j < high[1]; ++j)
      for (auto i = low[0]; i < high[0]; ++i) labels(i, j, k) = value;
}

validation::RegionTopology topology_of_mesh(const LabelVolume& labels, std::uint8_t region) {
  const auto mesh = mesh_of(labels);
  return validation::region_topologies(mesh, validation::mesh_faces(mesh))[region];
}

void expect_topology(const LabelVolume& labels, std::uint8_t region, std::size_t pieces, int handles, int cavities) {
  for (const auto& t : {validation::region_topology(labels, region), topology_of_mesh(labels, region)}) {
    EXPECT_EQ(t.components_ml.size(), pieces);
    EXPECT_EQ(t.handles, handles);
    EXPECT_EQ(t.cavities, cavities);
  }
}

TEST(RegionTopology, BallRingShellAndTwoPieces) {
  auto labels = empty_map(9);
  fill(labels, {2, 2, 2}, {7, 7, 7}, 1);
  expect_topology(labels, 1, 1, 0, 0);
  fill(labels, {4, 4, 2}, {5, 5, 7}, 0);  // a hole through it
  expect_topology(labels, 1, 1, 1, 0);
  fill(labels, {2, 4, 4}, {7, 5, 5}, 0);  // and a second one across: three handles
  expect_topology(labels, 1, 1, 3, 0);
  fill(labels, {2, 2, 2}, {7, 7, 7}, 1);
  fill(labels, {4, 4, 4}, {5, 5, 5}, 0);
  expect_topology(labels, 1, 1, 0, 1);
  fill(labels, {0, 0, 0}, {1, 1, 1}, 1);
  expect_topology(labels, 1, 2, 0, 1);
}

TEST(RegionTopology, OtherRegionsAreAroundJustAsTheOutside) {
  auto labels = empty_map(7);
  fill(labels, {0, 0, 0}, {7, 7, 7}, 2);
  fill(labels, {1, 1, 1}, {6, 6, 6}, 1);
  fill(labels, {3, 3, 3}, {4, 4, 4}, 3);
  expect_topology(labels, 1, 1, 0, 1);
  expect_topology(labels, 2, 1, 0, 1);
  expect_topology(labels, 3, 1, 0, 0);
}

TEST(RegionTopology, VoxelsThatTouchInAnEdgeOrACornerAreApart) {
  auto labels = empty_map(4);
  labels(1, 1, 1) = labels(2, 2, 1) = labels(3, 3, 2) = 1;
  expect_topology(labels, 1, 3, 0, 0);
}

TEST(RegionTopology, RandomMapsAgreeWithTheirMeshes) {
  std::uint32_t state = 4;
  for (const unsigned share : {90U, 128U, 170U}) {
    auto labels = empty_map(7);
    for (auto& voxel : labels.voxels) {
      state = state * 1664525U + 1013904223U;
      voxel = (state >> 24) < share ? 1 : 2;
    }
    const auto mesh = mesh_of(labels);
    auto of_regions = validation::region_topologies(mesh, validation::mesh_faces(mesh));
    for (const std::uint8_t region : {std::uint8_t{1}, std::uint8_t{2}}) {
      const auto of_voxels = validation::region_topology(labels, region);
      const auto& of_mesh = of_regions[region];
      ASSERT_EQ(of_mesh.components_ml.size(), of_voxels.components_ml.size());
      for (std::size_t i = 0; i < of_mesh.components_ml.size(); ++i)
        EXPECT_NEAR(of_mesh.components_ml[i], of_voxels.components_ml[i], 1e-12);
      EXPECT_EQ(of_mesh.handles, of_voxels.handles);
      EXPECT_EQ(of_mesh.cavities, of_voxels.cavities);
    }
  }
}

// ---- crossing surfaces ----

using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;

TEST(SelfIntersection, TrianglesApart) {
  const std::vector<Vec3> nodes = {{0, 0, 0},     {2, 0, 0},         {0, 2, 0}, {0.5, 0.5, -1}, {0.6, 0.5, 1},
                                   {0.5, 0.6, 1}, {0.5, 0.5, 1e-12}, {3, 3, 1}, {0.5, 0.5, 1}};
  EXPECT_EQ(validation::intersecting_faces(nodes, {{0, 1, 2}, {3, 4, 5}}), (Pairs{{0, 1}})) << "one pierces the other";
  EXPECT_EQ(validation::intersecting_faces(nodes, {{0, 1, 2}, {6, 7, 8}}), Pairs{}) << "just above";
  auto touching = nodes;
  touching[6].z = 0;
  EXPECT_EQ(validation::intersecting_faces(touching, {{0, 1, 2}, {6, 7, 8}}), (Pairs{{0, 1}})) << "touches";
  const std::vector<Vec3> flat = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.1, 0.1, 0}, {5, 0, 0},
                                  {0, 5, 0}, {3, 3, 0}, {5, 3, 0}, {3, 5, 0}};
  EXPECT_EQ(validation::intersecting_faces(flat, {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}), (Pairs{{0, 1}})) << "in one plane";
}

TEST(SelfIntersection, TrianglesWithCommonNodes) {
  const std::vector<Vec3> nodes = {{0, 0, 0},     {1, 0, 0}, {0, 1, 0},      {0, -1, 0},
                                   {0.3, 0.3, 0}, {0, 0, 1}, {0.4, 0.4, -1}, {0.4, 0.4, 1}};
  EXPECT_EQ(validation::intersecting_faces(nodes, {{0, 1, 2}, {1, 0, 3}}), Pairs{}) << "neighbours in a plane";
  EXPECT_EQ(validation::intersecting_faces(nodes, {{0, 1, 2}, {0, 1, 4}}), (Pairs{{0, 1}})) << "folded over an edge";
  EXPECT_EQ(validation::intersecting_faces(nodes, {{0, 1, 2}, {1, 0, 5}}), Pairs{}) << "a right angle";
  EXPECT_EQ(validation::intersecting_faces(nodes, {{0, 1, 2}, {0, 6, 7}}), (Pairs{{0, 1}})) << "through it at a corner";
  EXPECT_EQ(validation::intersecting_faces(nodes, {{0, 1, 2}, {0, 3, 5}}), Pairs{}) << "a common corner only";
}

TEST(SelfIntersection, SurfacesOfAMeshDoNotCrossUntilOneIsPulledThrough) {
  auto labels = empty_map(6);
  fill(labels, {0, 0, 0}, {6, 6, 2}, 1);
  fill(labels, {0, 0, 4}, {6, 6, 6}, 1);
  fill(labels, {0, 0, 2}, {2, 6, 4}, 1);  // a C: two plates and what holds them together
  auto mesh = mesh_of(labels);
  const auto outer = [&] {
    std::vector<Face> faces;
    for (const auto& face : validation::mesh_faces(mesh))
      if (face.other < 0) faces.push_back(face.nodes);
    return faces;
  };
  EXPECT_EQ(validation::intersecting_faces(mesh.nodes_mm, outer()), Pairs{});
  for (auto& p : mesh.nodes_mm)
    if (p.z < 2 && p.x > 3) p.z += 2.7;  // every cell stays positive: only together they overlap
  EXPECT_GT(validation::intersecting_faces(mesh.nodes_mm, outer()).size(), 0U);
}

// ---- against the label map ----

const ReportRow& row(const Report& report, const std::string& scope, const std::string& metric) {
  const auto found = std::find_if(report.begin(), report.end(),
                                  [&](const ReportRow& r) { return r.scope == scope && r.metric == metric; });
  if (found == report.end()) throw std::runtime_error("no row " + scope + " " + metric);
  return *found;
}

int label_of(const LabelVolume& labels, const Vec3& lps) {
  const Vec3 index = index_from_lps(labels.grid, lps);
  const auto i = std::lround(index.x), j = std::lround(index.y), k = std::lround(index.z);
  return labels.grid.contains(i, j, k) ? labels(i, j, k) : 0;
}

struct Cubes : ::testing::Test {
  LabelVolume labels = empty_map(10);
  void SetUp() override {
    fill(labels, {1, 1, 1}, {9, 9, 9}, 1);
    fill(labels, {3, 3, 3}, {7, 7, 7}, 6);
  }
  Report check(const TetMesh& mesh) const {
    ValidationSettings settings;
    settings.maximum_handles_added = 0;
    return validation::check_against_labels("mesh", mesh, validation::mesh_faces(mesh), labels, settings);
  }
  /// Distances to the voxels as cubes, so that they are known exactly.
  Report check_cubes(const TetMesh& mesh) const {
    return validation::check_against_level_sets("mesh", mesh, validation::mesh_faces(mesh), labels.grid,
                                                [this](const Vec3& p) { return label_of(labels, p); }, {});
  }
};

TEST_F(Cubes, ExactMeshHasNoError) {
  const auto report = check(mesh_of(labels)), distances = check_cubes(mesh_of(labels));
  for (const char* region : {"mesh/lv_myocardium", "mesh/lv_blood"}) {
    EXPECT_NEAR(row(report, region, "volume_difference").value, 0, 1e-9);
    EXPECT_EQ(row(report, region, "handles").value, row(report, region, "handles_of_labels").value);
    EXPECT_EQ(row(report, region, "cavities").value, row(report, region, "cavities_of_labels").value);
    EXPECT_EQ(row(report, region, "dice_with_labels").value, 1);
    EXPECT_LT(row(distances, region, "to_level_set_max").value, 2e-3) << "as far as intervals were halved";
    EXPECT_LT(row(distances, region, "from_level_set_max").value, 2e-3);
  }
  EXPECT_TRUE(all_passed(report));
}

TEST_F(Cubes, ShiftedMeshIsOffByItsShift) {
  auto mesh = mesh_of(labels);
  for (auto& p : mesh.nodes_mm) p.x += 0.3;
  const auto report = check_cubes(mesh);
  EXPECT_GE(row(report, "mesh", "to_level_set_p99").value, 0.3 - 2e-3);
  EXPECT_LE(row(report, "mesh", "to_level_set_p99").value, 0.3 * std::sqrt(2.0) + 2e-3) << "at the cubes' edges";
  EXPECT_NEAR(row(report, "mesh", "from_level_set_p99").value, 0.3, 2e-3);
  EXPECT_NEAR(row(check(mesh), "mesh/lv_blood", "centroid_shift").value, 0.3, 1e-9);
}

TEST_F(Cubes, WhatTheMeshLacksIsFarFromIt) {
  auto poorer = labels;
  fill(poorer, {1, 1, 7}, {9, 9, 9}, 0);  // two layers of voxels less
  const auto report = check(mesh_of(poorer));
  EXPECT_GE(row(report, "mesh/lv_myocardium", "from_labels_max").value, 2 - 2e-3);
  EXPECT_FALSE(row(report, "mesh/lv_myocardium", "volume_difference").passed());
  EXPECT_LT(row(report, "mesh/lv_myocardium", "dice_with_labels").value, 0.9);
  EXPECT_LT(row(report, "mesh/lv_myocardium", "volume_difference").value, -20);
  EXPECT_GE(row(report, "mesh/lv_myocardium", "from_labels_p99_in_edges").verdict(), Verdict::warned);
}

TEST_F(Cubes, WhatTheMeshHasTooMuchIsFarFromTheLabels) {
  auto richer = labels;
  fill(richer, {1, 1, 9}, {9, 9, 10}, 1);
  const auto report = check(mesh_of(richer));
  EXPECT_GE(row(report, "mesh/lv_myocardium", "to_labels_max").value, 1 - 2e-3);
  EXPECT_FALSE(row(report, "mesh/lv_myocardium", "volume_difference").passed());
}

TEST_F(Cubes, AHandleAndAPieceTooManyFail) {
  auto tunnel = labels;
  fill(tunnel, {4, 4, 0}, {6, 6, 3}, 6);
  fill(tunnel, {4, 4, 7}, {6, 6, 10}, 6);  // the blood goes right through the wall
  const auto with_tunnel = check(mesh_of(tunnel));
  EXPECT_EQ(row(with_tunnel, "mesh/lv_myocardium", "handles_of_labels").value, 0);
  EXPECT_EQ(row(with_tunnel, "mesh/lv_myocardium", "handles").value, 1);
  EXPECT_FALSE(row(with_tunnel, "mesh/lv_myocardium", "handles_added").passed());

  auto cut = labels;
  fill(cut, {1, 1, 4}, {9, 9, 6}, 0);
  const auto in_two = check(mesh_of(cut));
  EXPECT_EQ(row(in_two, "mesh/lv_blood", "pieces_of_labels").value, 1);
  EXPECT_FALSE(row(in_two, "mesh/lv_myocardium", "pieces_added").passed());
}

TEST_F(Cubes, StrandsThinnerThanAnEdgeAreNotMeasured) {
  const auto mesh = mesh_of(labels);
  fill(labels, {4, 4, 3}, {5, 5, 6}, 1);  // one voxel wide, three long, into the cavity
  EXPECT_LT(row(check_cubes(mesh), "mesh/lv_blood", "from_level_set_max_in_edges").value, 1);
  fill(labels, {3, 3, 3}, {7, 7, 7}, 6);
  fill(labels, {3, 3, 3}, {5, 5, 5}, 1);  // a block two wide, and two voxels of blood beside it
  EXPECT_GT(row(check_cubes(mesh), "mesh/lv_blood", "from_level_set_max_in_edges").value, 1);
}

TEST_F(Cubes, CrumbsOfTheLabelMapAreCountedNotMeasured) {
  const auto mesh = mesh_of(labels);
  fill(labels, {1, 1, 1}, {3, 3, 3}, 6);  // eight voxels; crumbs have fewer than 100 / 6
  const auto report = check(mesh);
  EXPECT_NEAR(row(report, "mesh/lv_blood", "crumbs_of_labels").value, 0.008, 1e-9);
  const auto without = check_cubes(mesh);
  EXPECT_LT(row(without, "mesh/lv_blood", "from_level_set_max").value, 1e-2);
  EXPECT_LT(row(without, "mesh/lv_myocardium", "to_level_set_max").value, 1e-2);
  fill(labels, {1, 1, 1}, {3, 3, 7}, 6);  // 24 voxels, beside the cavity: no crumb
  const auto with = check_cubes(mesh);
  EXPECT_GT(row(with, "mesh/lv_blood", "from_level_set_max").value, 1);
  EXPECT_GT(row(with, "mesh/lv_myocardium", "to_level_set_max").value, 1);
}

// Neither the normals of a wedge's faces nor the sides and diagonals of a cube lead from its edge into it.
TEST(ToLabels, TheEdgeOfASharpWedgeIsOnIt) {
  constexpr double low = 0.24, high = 0.62, length = 6;  // slopes: 13 to 32 degrees
  const auto label_at = [](const Vec3& p) {
    return p.x > 0 && p.x < length && p.y > low * p.x && p.y < high * p.x && p.z > 0 && p.z < length ? 1 : 0;
  };
  TetMesh mesh;
  for (const double z : {0.0, length})
    for (const Vec3& p : {Vec3{0, 0, z}, Vec3{length, low * length, z}, Vec3{length, high * length, z}})
      mesh.nodes_mm.push_back(p);
  mesh.cells = {{0, 1, 2, 5}, {0, 1, 5, 4}, {0, 4, 5, 3}};
  mesh.region.assign(3, 1);
  auto labels = empty_map(9);
  fill(labels, {0, 0, 0}, {9, 9, 9}, 1);
  const auto report =
      validation::check_against_level_sets("mesh", mesh, validation::mesh_faces(mesh), labels.grid, label_at, {});
  EXPECT_LT(row(report, "mesh/lv_myocardium", "to_level_set_max").value, 0.02);
}

TEST_F(Cubes, PiecesThatTouchAtAnEdgeMayBeOneInTheMesh) {
  auto split = empty_map(14);
  fill(split, {1, 1, 1}, {13, 13, 13}, 1);
  fill(split, {2, 2, 2}, {6, 6, 6}, 6);
  fill(split, {6, 6, 2}, {10, 10, 6}, 6);
  auto joined = split;
  fill(joined, {5, 6, 2}, {6, 7, 6}, 6);
  const auto lost = [&](const LabelVolume& of_mesh, const LabelVolume& of_labels) {
    labels = of_labels;
    return row(check(mesh_of(of_mesh)), "mesh/lv_blood", "pieces_lost").value;
  };
  EXPECT_EQ(lost(joined, split), 0);
  auto apart = split;
  fill(apart, {6, 6, 2}, {7, 10, 6}, 1);
  EXPECT_EQ(lost(joined, apart), 1);
}

TEST_F(Cubes, ALostRegionFails) {
  auto without = labels;
  std::replace(without.voxels.begin(), without.voxels.end(), std::uint8_t{6}, std::uint8_t{1});
  const auto report = check(mesh_of(without));
  EXPECT_EQ(row(report, "mesh/lv_blood", "pieces_lost").value, 1);
  EXPECT_FALSE(row(report, "mesh/lv_blood", "pieces_lost").passed());
}

}  // namespace
