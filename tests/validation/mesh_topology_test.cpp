// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/mesh_topology.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "tests/support/two_region_mesh.hpp"

namespace heartgen::validation {
namespace {

TEST(MeshFaces, AreThoseOfTheCellsAscending) {
  const TetMesh mesh = heartgen::testing::two_region_mesh(3);
  std::map<Face, std::vector<std::int32_t>> cells_of;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t without = 0; without < 4; ++without) {
      Face face{};
      for (std::size_t i = 0, k = 0; i < 4; ++i)
        if (i != without) face[k++] = mesh.cells[c][i];
      std::sort(face.begin(), face.end());
      cells_of[face].push_back(static_cast<std::int32_t>(c));
    }
  const auto faces = mesh_faces(mesh);
  ASSERT_EQ(faces.size(), cells_of.size());
  auto expected = cells_of.begin();
  for (const auto& face : faces) {
    const auto& [nodes, cells] = *expected++;
    EXPECT_EQ(face.nodes, nodes);
    EXPECT_EQ(face.cell, cells.front());
    EXPECT_EQ(face.other, cells.size() > 1 ? cells.back() : -1);
    EXPECT_EQ(face.cells, static_cast<std::int32_t>(cells.size()));
  }
}

TEST(MeshFaces, KeepFacesOfThreeCellsAndNoneOfNodesThatAreNotThere) {
  TetMesh mesh;
  mesh.nodes_mm.resize(6);
  mesh.cells = {{0, 1, 2, 3}, {2, 1, 0, 4}, {0, 2, 1, 5}};
  mesh.region = {1, 1, 2};
  const auto faces = mesh_faces(mesh);
  ASSERT_EQ(faces.size(), 10U);
  EXPECT_EQ(faces.front().nodes, (Face{0, 1, 2}));
  EXPECT_EQ(faces.front().cells, 3);
  EXPECT_EQ(faces.front().cell, 0);
  EXPECT_EQ(faces.front().other, 2);
  mesh.cells[1][3] = 6;
  EXPECT_TRUE(mesh_faces(mesh).empty());
}

}  // namespace
}  // namespace heartgen::validation
