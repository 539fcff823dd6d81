#include "generator/lattice/refine.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "lattice/shapes.hpp"

namespace {

using namespace heart;
using namespace heart::testing;

TEST(Refine, SpotsHalveTheEdgesInThem) {
  auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 10, 2);
  m.finest_edge_mm = 2;
  std::vector<lattice::FineSpot> spots;
  ASSERT_TRUE(lattice::add_spots(spots, {{1, 2, 3}}, m, 1));
  ASSERT_EQ(spots.size(), 1U);
  const auto fine = lattice::refined_at(m, spots);
  EXPECT_DOUBLE_EQ(fine.edge_mm({1, 2, 3}), 1);
  EXPECT_DOUBLE_EQ(fine.edge_mm({1, 2, 3 + 1.01 * spots[0].radius_mm}), 2);
}

TEST(Refine, SpotsThatAreCoveredAreNotAddedAgainButFinerOnes) {
  auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 10, 2);
  m.finest_edge_mm = 2;
  std::vector<lattice::FineSpot> spots;
  ASSERT_TRUE(lattice::add_spots(spots, {{0, 0, 0}, {0.1, 0, 0}}, m, 1));
  EXPECT_EQ(spots.size(), 1U);
  for (const double edge : {0.5, 0.25}) {
    ASSERT_TRUE(lattice::add_spots(spots, {{0, 0, 0}}, m, 1));
    EXPECT_DOUBLE_EQ(lattice::refined_at(m, spots).edge_mm({0, 0, 0}), edge);
  }
  EXPECT_FALSE(lattice::add_spots(spots, {{0, 0, 0}}, m, 1)) << "three halvings at most";
}

// Edges elsewhere may be no multiple of those in a spot: they stay as they are.
TEST(Refine, ElsewhereTheLatticeStays) {
  auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 10, 2);
  m.edge_mm = [](const Vec3& p) { return p.x > 0 ? 1.4 : 1.2; };
  m.finest_edge_mm = 1.2;
  std::vector<lattice::FineSpot> spots;
  ASSERT_TRUE(lattice::add_spots(spots, {{4, 0, 0}}, m, 2));
  const auto fine = lattice::refined_at(m, spots);
  EXPECT_DOUBLE_EQ(fine.finest_edge_mm, 0.3);
  const auto far_from_spot = [](const Complex& c) {
    return std::count_if(c.nodes_mm.begin(), c.nodes_mm.end(), [](const Vec3& p) { return p.x < -2; });
  };
  EXPECT_EQ(far_from_spot(lattice::stuff(fine, {})), far_from_spot(lattice::stuff(m, {})));
}

TEST(Refine, ALargeBoxOfFineCellsIsNotMadeFiner) {
  auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 200, 1);
  m.finest_edge_mm = 1;
  std::vector<lattice::FineSpot> spots;
  ASSERT_TRUE(lattice::add_spots(spots, {{4, 0, 0}}, m, 1));
  EXPECT_DOUBLE_EQ(lattice::refined_at(m, spots).finest_edge_mm, 1);
}

// Samples could find that of a spot, and make an octree of it that no machine holds.
TEST(Refine, WithoutAKnownFinestEdgeNothingChanges) {
  const auto m = ball_of_two_halves();
  std::vector<lattice::FineSpot> spots;
  ASSERT_TRUE(lattice::add_spots(spots, {{4, 0, 0}}, m, 3));
  EXPECT_DOUBLE_EQ(lattice::refined_at(m, spots).edge_mm({4, 0, 0}), 0.9);
}

TEST(Refine, ACellOfAnotherRegionIsAStray) {
  const auto m = ball_of_two_halves();
  auto c = mesh_of(m).complex;
  std::vector<std::uint8_t> is_changed(c.cells.size(), 0);
  EXPECT_TRUE(lattice::far_strays(c, m, ~0U, is_changed).empty());
  const auto is_deep = [&](const Cell& cell) {
    return std::all_of(cell.begin(), cell.end(), [&](auto n) { return c.at(n).z > 1.5 && norm(c.at(n)) < 3; });
  };
  const auto deep = static_cast<std::size_t>(std::find_if(c.cells.begin(), c.cells.end(), is_deep) - c.cells.begin());
  ASSERT_LT(deep, c.cells.size());
  c.label[deep] = 2;
  is_changed[deep] = 1;
  lattice::derive_touches(c);
  EXPECT_EQ(lattice::far_strays(c, m, ~0U, is_changed).size(), 1U);
  EXPECT_TRUE(lattice::far_strays(c, m, lattice::bit_of(3), is_changed).empty()) << "only of the labels asked for";
}

}  // namespace
