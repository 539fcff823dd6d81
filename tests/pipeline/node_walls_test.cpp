// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/node_walls.hpp"

#include <gtest/gtest.h>

#include "model/labels.hpp"

namespace heartgen {
namespace {

TEST(NodeWalls, NodesOfSeveralRegionsAreNoRegionsOwn) {
  constexpr int lv = tag(Region::lv_myocardium), rv = tag(Region::rv_myocardium), muscle = tag(Region::papillary);
  TetMesh mesh;
  mesh.nodes_mm.resize(9);
  mesh.cells = {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}, {4, 5, 6, 7}};
  mesh.region = {rv, lv, lv, muscle};
  EXPECT_EQ(pipeline::regions_of_nodes(mesh),
            (std::vector<std::int32_t>{rv, rv, rv, rv, muscle, muscle, muscle, muscle, 0}));
  EXPECT_EQ(pipeline::regions_of_own_nodes(mesh), (std::vector<std::int32_t>{rv, 0, 0, 0, 0, 0, muscle, muscle, 0}));
}

}  // namespace
}  // namespace heartgen
