// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/active_leaves.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "generator/parallel/threads.hpp"
#include "generator/stuffing/lattice_cells.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

using Point = std::array<double, 3>;
using PointCell = std::array<Point, 4>;

// Two thin curved sheets that reach a side of the box, on a lattice that gets coarser away from the first.
int label_at(const Vec3& p) {
  const double radius = norm(p - Vec3{3, 2, 1});
  return std::abs(radius - 6) < 0.8 ? 1 : std::abs(radius - 17) < 0.6 ? 2 : 0;
}

stuffing::Octree graded_tree() {
  const auto edge = [](const Vec3& p) { return 1 + 0.3 * std::max(0.0, std::abs(norm(p - Vec3{3, 2, 1}) - 6) - 2); };
  return stuffing::make_octree(stuffing::wanted_levels({-20, -20, -20}, {24, 20, 20}, 1, edge), edge);
}

Point point(const stuffing::Background& b, std::int32_t n) {
  const Vec3& p = b.nodes_mm[static_cast<std::size_t>(n)];
  return {p.x, p.y, p.z};
}

PointCell points(const stuffing::Background& b, const Cell& cell) {
  PointCell found{point(b, cell[0]), point(b, cell[1]), point(b, cell[2]), point(b, cell[3])};
  std::sort(found.begin(), found.end());
  return found;
}

// Cells that share a node with a cell with a labelled node, found by looking at all of the lattice.
std::set<PointCell> cells_wanted(const stuffing::Background& whole) {
  std::vector<std::uint8_t> is_near(whole.nodes_mm.size(), 0);
  for (const auto& cell : whole.cells)
    if (std::any_of(cell.begin(), cell.end(),
                    [&](std::int32_t n) { return label_at(whole.nodes_mm[static_cast<std::size_t>(n)]) != 0; }))
      for (const auto n : cell) is_near[static_cast<std::size_t>(n)] = 1;
  std::set<PointCell> wanted;
  for (const auto& cell : whole.cells)
    if (std::any_of(cell.begin(), cell.end(),
                    [&](std::int32_t n) { return is_near[static_cast<std::size_t>(n)] != 0; }))
      wanted.insert(points(whole, cell));
  return wanted;
}

std::map<Point, int> cells_per_node(const stuffing::Background& b) {
  std::map<Point, int> counts;
  for (const auto& cell : b.cells)
    for (const auto n : cell) ++counts[point(b, n)];
  return counts;
}

TEST(NearLeaves, HoldAllCellsAroundLabelledNodesAndTheirLabels) {
  const auto tree = graded_tree();
  const auto whole = stuffing::make_background(tree);
  const auto part = stuffing::make_background(tree, label_at, stuffing::active_leaves(tree, label_at));
  EXPECT_LT(part.cells.size(), whole.cells.size());
  std::set<PointCell> made;
  for (const auto& cell : part.cells) made.insert(points(part, cell));
  const auto wanted = cells_wanted(whole);
  ASSERT_GT(wanted.size(), 1000U);
  EXPECT_TRUE(std::includes(made.begin(), made.end(), wanted.begin(), wanted.end()));
  ASSERT_EQ(part.label.size(), part.nodes_mm.size());
  for (std::size_t n = 0; n < part.label.size(); ++n) EXPECT_EQ(part.label[n], label_at(part.nodes_mm[n]));
}

TEST(NearLeaves, NodesOfTheirCellsKnowWhetherOthersWereNotMade) {
  const auto tree = graded_tree();
  const auto whole = stuffing::make_background(tree);
  const auto part = stuffing::make_background(tree, label_at, stuffing::active_leaves(tree, label_at));
  const auto in_whole = cells_per_node(whole), in_part = cells_per_node(part);
  std::set<Point> nodes;
  for (const auto& cell : cells_wanted(whole)) nodes.insert(cell.begin(), cell.end());
  int lacking = 0;
  for (std::size_t n = 0; n < part.nodes_mm.size(); ++n) {
    const auto at = point(part, static_cast<std::int32_t>(n));
    if (!nodes.contains(at)) continue;
    EXPECT_EQ(part.lacks_cells[n] != 0, in_part.at(at) < in_whole.at(at));
    lacking += part.lacks_cells[n];
  }
  EXPECT_GT(lacking, 0);
}

TEST(NearLeaves, SameBitsForAnyNumberOfThreads) {
  const auto tree = graded_tree();
  std::vector<stuffing::Background> made;
  for (const int threads : {1, 2, 5}) {
    parallel::set_thread_count(threads);
    made.push_back(stuffing::make_background(tree, label_at, stuffing::active_leaves(tree, label_at)));
  }
  parallel::set_thread_count(2);
  for (const auto& b : made) {
    EXPECT_EQ(b.nodes_mm, made[0].nodes_mm);
    EXPECT_EQ(b.spacing_mm, made[0].spacing_mm);
    EXPECT_EQ(b.sides, made[0].sides);
    EXPECT_EQ(b.cells, made[0].cells);
    EXPECT_EQ(b.lacks_cells, made[0].lacks_cells);
  }
}

}  // namespace
