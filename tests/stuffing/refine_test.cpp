// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/stuffing/refine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "generator/stuffing/background_lattice.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

Materials solid_ball(double half_mm, double edge_mm) {
  auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, half_mm, edge_mm);
  m.finest_edge_mm = edge_mm;
  return m;
}

// Width of the leaf over a position, in mm.
double width_at(const stuffing::Octree& tree, const Vec3& p) {
  const auto at = tree.finest_cell_at(p);
  return std::ldexp(tree.step_mm.x, tree.leaf_over(at).level);
}

stuffing::Octree tree_of(const Materials& m) { return stuffing::build_background_lattice(m).tree; }

TEST(Refine, SpotsHalveTheEdgesInThem) {
  auto m = solid_ball(10, 1);
  const auto plain = tree_of(m);
  ASSERT_TRUE(stuffing::add_spots(m, {{1, 2, 3}}, 1));
  ASSERT_EQ(m.spots.size(), 1U);
  const auto tree = tree_of(m);
  EXPECT_DOUBLE_EQ(width_at(tree, {1, 2, 3}), 0.5 * width_at(plain, {1, 2, 3}));
  const Vec3 beyond{1, 2, 3 - m.spots[0].radius_mm - 2.5};
  EXPECT_DOUBLE_EQ(width_at(tree, beyond), width_at(plain, beyond));
}

TEST(Refine, SpotsThatAreCoveredAreNotAddedAgainButFinerOnes) {
  auto m = solid_ball(10, 2);
  ASSERT_TRUE(stuffing::add_spots(m, {{0, 0, 0}, {0.1, 0, 0}}, 1));
  EXPECT_EQ(m.spots.size(), 1U);
  const double coarse = width_at(tree_of(m), {0, 0, 0});
  for (const double share : {0.5, 0.25}) {
    ASSERT_TRUE(stuffing::add_spots(m, {{0, 0, 0}}, 1));
    EXPECT_DOUBLE_EQ(width_at(tree_of(m), {0, 0, 0}), share * coarse);
  }
  EXPECT_FALSE(stuffing::add_spots(m, {{0, 0, 0}}, 1)) << "three halvings at most";
}

// Edges elsewhere may be no multiple of those in a spot, and the finest of them need not be known.
TEST(Refine, ElsewhereTheLatticeStays) {
  for (const bool is_known : {true, false}) {
    auto m = solid_ball(10, 1.2);
    m.edge_mm = [](const Vec3& p) { return p.x > 0 ? 1.4 : 1.2; };
    if (!is_known) m.finest_edge_mm = 0;
    const auto plain = stuffing::stuff_isosurfaces(m, {});
    ASSERT_TRUE(stuffing::add_spots(m, {{5, 0, 0}}, 2));
    const auto fine = stuffing::stuff_isosurfaces(m, {});
    EXPECT_GT(fine.cells.size(), plain.cells.size());
    const auto far_from_spot = [](const Complex& c) {
      std::vector<Vec3> nodes;
      std::copy_if(c.nodes_mm.begin(), c.nodes_mm.end(), std::back_inserter(nodes),
                   [](const Vec3& p) { return p.x < -2.5; });
      std::sort(nodes.begin(), nodes.end(),
                [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
      return nodes;
    };
    EXPECT_GT(far_from_spot(plain).size(), 10U);
    EXPECT_EQ(far_from_spot(fine), far_from_spot(plain));
  }
}

TEST(Refine, ALargeBoxOfFineCellsIsNotMadeFiner) {
  auto m = solid_ball(160, 1);
  const auto plain = tree_of(m);
  ASSERT_TRUE(stuffing::add_spots(m, {{4, 0, 0}}, 1));
  EXPECT_EQ(tree_of(m).size, plain.size);
}

TEST(Refine, ACellOfAnotherRegionIsAStray) {
  const auto m = ball_of_two_halves();
  auto c = mesh_of(m).complex;
  std::vector<std::uint8_t> is_changed(c.cells.size(), 0);
  EXPECT_TRUE(stuffing::far_mislabelled_cells(c, m, ~0U, is_changed).empty());
  const auto is_deep = [&](const Cell& cell) {
    return std::all_of(cell.begin(), cell.end(), [&](auto n) { return c.at(n).z > 1.5 && norm(c.at(n)) < 3; });
  };
  const auto deep = static_cast<std::size_t>(std::find_if(c.cells.begin(), c.cells.end(), is_deep) - c.cells.begin());
  ASSERT_LT(deep, c.cells.size());
  c.label[deep] = 2;
  is_changed[deep] = 1;
  tetmesh::derive_touches(c);
  EXPECT_EQ(stuffing::far_mislabelled_cells(c, m, ~0U, is_changed).size(), 1U);
  EXPECT_TRUE(stuffing::far_mislabelled_cells(c, m, tetmesh::bit_of(3), is_changed).empty())
      << "only of the labels asked for";
}

}  // namespace
