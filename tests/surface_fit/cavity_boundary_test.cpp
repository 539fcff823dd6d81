// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/cavity_boundary.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "generator/surface_fit/self_intersections.hpp"
#include "generator/tetmesh/cavity.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

constexpr double edge_mm = 0.9, gap_mm = 0.6;

/// Two balls, two thirds of an edge from each other, one after the other along x.
Materials balls_side_by_side() {
  return materials_of({[](const Vec3&) { return 0.0; },
                       [](const Vec3& p) {
                         const double from_middle = 3 + 0.5 * gap_mm;
                         return std::max(3 - norm(p - Vec3{from_middle, 0, 0}), 3 - norm(p + Vec3{from_middle, 0, 0}));
                       }},
                      8, edge_mm);
}

/// The node of the ball at low x that is nearest to the other one, and a cell there.
std::int32_t pole(const Complex& c) {
  std::int32_t found = -1;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(c.nodes_mm.size()); ++n)
    if (c.at(n).x < 0 && !c.star(n).empty() && (found < 0 || c.at(n).x > c.at(found).x)) found = n;
  return found;
}

struct PoleOfBall {
  tetmesh::Cavity place;
  surface_fit::CavityBoundary around;
  std::size_t node;  // of the part
};

PoleOfBall pole_of_ball(const Complex& c) {
  const auto node = pole(c);
  auto place = tetmesh::cavity_around(c, c.star(node)[0], 2);
  auto around = surface_fit::faces_around(c, surface_fit::by_height(c, surface_fit::outer_faces(c)), place);
  const auto own = std::ranges::lower_bound(place.nodes, node) - place.nodes.begin();
  return {std::move(place), std::move(around), static_cast<std::size_t>(own)};
}

TEST(CavityBoundary, FacesOfASoundMeshDoNotMeet) {
  const auto c = mesh_of(balls_side_by_side()).complex;
  const auto outer = surface_fit::by_height(c, surface_fit::outer_faces(c));
  for (std::int32_t cell = 0; cell < static_cast<std::int32_t>(c.cells.size()); cell += 50) {
    const auto place = tetmesh::cavity_around(c, cell, 2);
    const auto around = surface_fit::faces_around(c, outer, place);
    EXPECT_EQ(surface_fit::count_meeting(place.part, around), 0U);
    EXPECT_TRUE(surface_fit::is_within_reach(place.part, around));
  }
}

TEST(CavityBoundary, ASheetBesideThePlaceIsKnown) {
  const auto c = mesh_of(balls_side_by_side()).complex;
  auto [place, around, node] = pole_of_ball(c);
  double end_mm = -8;
  for (const auto& p : place.part.nodes_mm) end_mm = std::max(end_mm, p.x);
  ASSERT_LT(end_mm, 0);  // the other ball lies beyond the part
  place.part.nodes_mm[node].x = gap_mm;
  EXPECT_TRUE(surface_fit::is_within_reach(place.part, around));
  EXPECT_GT(surface_fit::count_meeting(place.part, around), 0U);
}

TEST(CavityBoundary, WhatLeavesThePlaceByFarIsBeyondReach) {
  const auto c = mesh_of(balls_side_by_side()).complex;
  auto [place, around, node] = pole_of_ball(c);
  place.part.nodes_mm[node].x += 3 * edge_mm;
  EXPECT_FALSE(surface_fit::is_within_reach(place.part, around));
}

TEST(FreeCellsAround, AreThePlaceUnlessOneOfItsNodesIsTaken) {
  const auto c = mesh_of(balls_side_by_side()).complex;
  const auto cell = c.star(pole(c))[0];
  std::vector<std::uint8_t> is_taken(c.nodes_mm.size(), 1);
  const auto place = tetmesh::cavity_around(c, cell, 2);
  for (const auto n : place.nodes) is_taken[static_cast<std::size_t>(n)] = 0;
  EXPECT_EQ(tetmesh::free_cells_around(c, cell, 2, is_taken), place.cells);
  EXPECT_TRUE(tetmesh::free_cells_around(c, cell, 3, is_taken).empty());
  for (const auto n : place.nodes) {
    is_taken[static_cast<std::size_t>(n)] = 1;
    EXPECT_TRUE(tetmesh::free_cells_around(c, cell, 2, is_taken).empty()) << n;
    is_taken[static_cast<std::size_t>(n)] = 0;
  }
}

}  // namespace
