// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/lattice_cells.hpp"

#include <gtest/gtest.h>

#include "generator/stuffing/octree.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

// Fine in a ball, growing away from it.
double graded_edge(const Vec3& p) { return 1 + 0.5 * std::max(0.0, norm(p - Vec3{3, 2, 1}) - 4); }

stuffing::Octree graded_tree() {
  return stuffing::make_octree(stuffing::wanted_levels({-20, -20, -20}, {24, 20, 20}, 1, graded_edge), graded_edge);
}

TEST(Octree, LeavesFillTheBoxOnce) {
  const auto tree = graded_tree();
  std::int64_t cells = 0;
  for (const auto& leaf : tree.leaves) cells += std::int64_t{1} << (3 * leaf.level);
  EXPECT_EQ(cells, static_cast<std::int64_t>(tree.level.size()));
  for (const auto& leaf : tree.leaves) EXPECT_EQ(tree.level[tree.offset(leaf.low)], leaf.level);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(tree.step_mm[axis] * tree.size[static_cast<std::size_t>(axis)], axis == 0 ? 44 : 40, 1e-9);
}

TEST(Octree, LeavesThatShareAnEdgeDifferByAFactorOfTwoAtMost) {
  const auto tree = graded_tree();
  int levels = 0;
  const auto& n = tree.size;
  for (std::int32_t k = 0; k < n[2]; ++k)
    for (std::int32_t j = 0; j < n[1]; ++j)
      for (std::int32_t i = 0; i < n[0]; ++i) {
        const int level = tree.level[tree.offset({i, j, k})];
        levels |= 1 << level;
        for (int d = 0; d < 27; ++d) {
          const std::int32_t di = d % 3 - 1, dj = d / 3 % 3 - 1, dk = d / 9 - 1;
          const stuffing::TreeIndex at{i + di, j + dj, k + dk};
          if (di * dj * dk != 0 || at[0] < 0 || at[1] < 0 || at[2] < 0 || at[0] >= n[0] || at[1] >= n[1] ||
              at[2] >= n[2])
            continue;
          ASSERT_LE(std::abs(level - tree.level[tree.offset(at)]), 1);
        }
      }
  EXPECT_EQ(levels & 3, 3) << "there is something to grade";
}

TEST(Octree, CellsAreNoLargerThanWanted) {
  const auto tree = graded_tree();
  for (const auto& leaf : tree.leaves) {
    const double half = 0.5 * (1 << leaf.level);
    const Vec3 center =
        tree.origin_mm + Vec3{(leaf.low[0] + half) * tree.step_mm.x, (leaf.low[1] + half) * tree.step_mm.y,
                              (leaf.low[2] + half) * tree.step_mm.z};
    const double mean_edge = stuffing::mean_edge_per_cell * 2 * half * tree.step_mm.x;
    EXPECT_TRUE(leaf.level == 0 || mean_edge < 1.05 * 1.42 * graded_edge(center)) << leaf.level;
  }
}

TEST(Background, CellsFillTheBoxWithoutGapsOrOverlaps) {
  const auto background = stuffing::make_background(graded_tree());
  Complex c;
  c.nodes_mm = background.nodes_mm;
  c.cells = background.cells;
  double volume = 0;
  for (const auto& cell : c.cells) volume += volume_of(c, cell);
  EXPECT_NEAR(volume, 44 * 40 * 40, 1e-6 * volume);
  EXPECT_GT(min_volume(c), 0);
  for (const auto& [face, count] : face_counts(c.cells)) {
    const LabelBits sides = background.sides[static_cast<std::size_t>(face[0])] &
                            background.sides[static_cast<std::size_t>(face[1])] &
                            background.sides[static_cast<std::size_t>(face[2])];
    ASSERT_EQ(count, sides != 0 ? 1 : 2) << "faces inside have two cells, faces on a side have one";
  }
}

TEST(Background, AnglesLieBetween45And120Degrees) {
  const auto background = stuffing::make_background(
      stuffing::make_octree(stuffing::wanted_levels({-16, -16, -16}, {16, 16, 16}, 0.9235, graded_edge), graded_edge));
  Complex c;
  c.nodes_mm = background.nodes_mm;
  c.cells = background.cells;
  const auto range = dihedral_range(c);
  EXPECT_GT(range[0], 44.9);
  EXPECT_LT(range[1], 120.1);
}

}  // namespace
