// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/parent_fibers.hpp"

#include <gtest/gtest.h>

#include "model/error.hpp"

namespace heartgen {
namespace {

/// Three cells in a row on six nodes; the middle one is the part.
TetMesh row_of_cells() {
  TetMesh mesh;
  for (int n = 0; n < 6; ++n) mesh.nodes_mm.push_back({1.0 * n, 0, 0});
  mesh.cells = {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}};
  mesh.region = {17, 1, 17};
  return mesh;
}

TetMesh middle_part() {
  TetMesh part;
  part.nodes_mm.resize(4);
  part.cells = {{0, 1, 2, 3}};
  part.parent_cell = {1};
  part.parent_node = {1, 2, 3, 4};
  part.cell_fibers = {{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
  part.node_fibers = {std::vector<Vec3>(4, {0, 1, 0}), std::vector<Vec3>(4, {0, 0, 1}),
                      std::vector<Vec3>(4, {1, 0, 0})};
  part.fiber_source = {1, 1, 2, 3};
  return part;
}

TEST(ParentFibers, StandWhereThePartIsAndAreZeroElsewhere) {
  TetMesh whole = row_of_cells();
  carry_fibers_to_parent(middle_part(), whole);
  EXPECT_EQ(whole.cell_fibers.fiber, (std::vector<Vec3>{{}, {1, 0, 0}, {}}));
  EXPECT_EQ(whole.cell_fibers.sheet_normal, (std::vector<Vec3>{{}, {0, 0, 1}, {}}));
  EXPECT_EQ(whole.node_fibers.fiber[0], Vec3{});
  EXPECT_EQ(whole.node_fibers.fiber[4], (Vec3{0, 1, 0}));
  EXPECT_EQ(whole.node_fibers.fiber[5], Vec3{});
  EXPECT_EQ(whole.fiber_source, (std::vector<std::uint8_t>{0, 1, 1, 2, 3, 0}));
}

TEST(ParentFibers, APartWithoutFibresOrParentChangesNothing) {
  TetMesh whole = row_of_cells(), bare = middle_part(), loose = middle_part();
  bare.cell_fibers = {};
  loose.parent_cell.clear();
  carry_fibers_to_parent(bare, whole);
  carry_fibers_to_parent(loose, whole);
  EXPECT_TRUE(whole.cell_fibers.fiber.empty());
  EXPECT_TRUE(whole.fiber_source.empty());
}

TEST(ParentFibers, IdsOfAnotherMeshAreRefused) {
  TetMesh whole = row_of_cells(), part = middle_part();
  part.parent_node[3] = 6;
  EXPECT_THROW(carry_fibers_to_parent(part, whole), UserError);
}

}  // namespace
}  // namespace heartgen
