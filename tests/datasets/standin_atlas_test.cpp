// SPDX-License-Identifier: GPL-3.0-or-later
// The stand-in atlas is a valid mesh of two ventricles with the helix angles that it claims.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "datasets/phantom/phantom.hpp"
#include "model/labels.hpp"

namespace heartgen::phantom {
namespace {

const TetMesh& atlas() {
  static const TetMesh mesh = make_standin_atlas();
  return mesh;
}

std::map<Face, int> faces_of(const TetMesh& mesh) {
  std::map<Face, int> faces;
  for (const auto& cell : mesh.cells)
    for (std::size_t skip = 0; skip < 4; ++skip) {
      Face face;
      std::size_t next = 0;
      for (std::size_t n = 0; n < 4; ++n)
        if (n != skip) face[next++] = cell[n];
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  return faces;
}

TEST(StandinAtlas, CellsArePositiveAndEveryNodeIsUsed) {
  const auto& mesh = atlas();
  EXPECT_GT(mesh.cells.size(), 20000u);
  EXPECT_LT(mesh.cells.size(), 40000u);
  std::vector<char> used(mesh.nodes_mm.size(), 0);
  double lv_ml = 0, rv_ml = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const double volume = cell_volume_mm3(mesh, mesh.cells[c]);
    EXPECT_GT(volume, 0.05);
    (mesh.region[c] == tag(Region::lv_myocardium) ? lv_ml : rv_ml) += volume / 1000;
    for (const auto node : mesh.cells[c]) used[static_cast<std::size_t>(node)] = 1;
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
  EXPECT_GT(lv_ml, 90);
  EXPECT_LT(lv_ml, 160);
  EXPECT_GT(rv_ml, 25);
  EXPECT_LT(rv_ml, 60);
}

TEST(StandinAtlas, TheVentriclesShareNoNodeSoThatFibersCanJumpWhereTheyMeet) {
  std::vector<std::int32_t> region(atlas().nodes_mm.size(), 0);
  for (std::size_t c = 0; c < atlas().cells.size(); ++c)
    for (const auto node : atlas().cells[c]) {
      auto& known = region[static_cast<std::size_t>(node)];
      ASSERT_TRUE(known == 0 || known == atlas().region[c]);
      known = atlas().region[c];
    }
}

TEST(StandinAtlas, SurfaceIsAClosedManifold) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& [face, count] : faces_of(atlas())) {
    ASSERT_LE(count, 2);
    if (count == 1)
      for (std::size_t n = 0; n < 3; ++n) ++edges[std::minmax(face[n], face[(n + 1) % 3])];
  }
  for (const auto& [edge, count] : edges) ASSERT_EQ(count, 2) << edge.first << " " << edge.second;
}

TEST(StandinAtlas, FramesAreOrthonormal) {
  const auto& f = atlas().node_fibers;
  ASSERT_EQ(f.fiber.size(), atlas().nodes_mm.size());
  for (std::size_t n = 0; n < f.fiber.size(); ++n) {
    EXPECT_NEAR(norm(f.fiber[n]), 1, 1e-9);
    EXPECT_NEAR(dot(f.fiber[n], f.sheet[n]), 0, 1e-6);
    EXPECT_NEAR(norm(f.sheet_normal[n]), 1, 1e-6);
  }
}

TEST(StandinAtlas, HelixTurnsFromPlusToMinusSixty) {
  const auto& mesh = atlas();

  const Vec3 axis = normalized({-0.52, 0.66, 0.54});
  double top = -1e9;
  for (const auto& p : mesh.nodes_mm) top = std::max(top, dot(p, axis));
  int steep_up = 0, steep_down = 0, all = 0;
  for (std::size_t n = 0; n < mesh.nodes_mm.size(); ++n) {
    if (dot(mesh.nodes_mm[n], axis) < top - 55) continue;  // away from the apex
    const Vec3 fiber = mesh.node_fibers.fiber[n], outward = mesh.node_fibers.sheet[n];
    const Vec3 along = normalized(axis - dot(axis, outward) * outward), around = cross(along, outward);
    const double sign = dot(fiber, around) < 0 ? -1 : 1;
    const double angle = std::atan2(sign * dot(fiber, along), sign * dot(fiber, around)) * 180 / 3.14159265358979;
    EXPECT_LT(std::abs(angle), 60.5);
    ++all;
    steep_up += angle > 59;
    steep_down += angle < -59;
  }
  EXPECT_GT(steep_up, all / 8);
  EXPECT_GT(steep_down, all / 8);
}

}  // namespace
}  // namespace heartgen::phantom
