// SPDX-License-Identifier: GPL-3.0-or-later
// Exchanges where many materials meet.
#include "generator/tetmesh/flips.hpp"

#include <gtest/gtest.h>

#include "generator/tetmesh/collapse.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/ring.hpp"
#include "generator/tetmesh/surface_faces.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

/// A cell inside a ball of cells, as the tip of material 1 that sticks into material 2: beyond its first face lies
/// more of material 1, and at each of that face's edges a wedge of a material of its own parts the two.
struct Tip {
  Complex complex;
  std::int32_t cell = -1;
};

bool is_deep_inside(const Complex& c, std::int32_t id) {
  for (const auto n : c.cell(id))
    for (const auto t : c.star(n))
      for (const auto other : c.cell(t))
        if (norm(c.at(other)) > 4) return false;
  return true;
}

// Whether the ring around each edge of the cell's first face has a cell that touches neither the apex nor that face.
bool place_wedges(Complex& c, std::int32_t id, int wedges) {
  const Cell cell = c.cell(id);
  const auto beyond = tetmesh::cells_at_face(c, cell[1], cell[2], cell[3]);
  for (int w = 0; w < wedges; ++w) {
    const auto a = cell[1 + static_cast<std::size_t>(w)], b = cell[1 + static_cast<std::size_t>(w + 1) % 3];
    const auto ring = tetmesh::ring_around(c, a, b);
    std::int32_t found = -1;
    for (std::size_t i = 0; i < ring.size; ++i) {
      const auto t = ring.cells[i];
      if (t != beyond[0] && t != beyond[1] && !tetmesh::has(c.cell(t), cell[0])) found = t;
    }
    if (found < 0) return false;
    c.label[static_cast<std::size_t>(found)] = static_cast<std::uint8_t>(3 + w);
  }
  for (const auto t : beyond) c.label[static_cast<std::size_t>(t)] = 1;
  return true;
}

Tip tip_between(int wedges) {
  const auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 6, 1);
  Tip tip{stuffing::stuff_isosurfaces(m, {})};
  auto& c = tip.complex;
  tetmesh::derive_touches(c);
  tetmesh::compress(c);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(c.cells.size()) && tip.cell < 0; ++t) {
    std::fill(c.label.begin(), c.label.end(), std::uint8_t{2});
    if (is_deep_inside(c, t) && place_wedges(c, t, wedges)) tip.cell = t;
  }
  tetmesh::derive_touches(c);
  return tip;
}

TEST(RelabelTip, FiveMaterialsMeet) {
  for (int wedges = 0; wedges <= 3; ++wedges) {
    auto [c, cell] = tip_between(wedges);
    ASSERT_GE(cell, 0);
    EXPECT_TRUE(tetmesh::relabel_spike(c, cell)) << 2 + wedges << " materials";
    EXPECT_EQ(c.label_of(cell), 2);
    for (const auto n : c.cell(cell)) EXPECT_NE(c.bits(n) & tetmesh::bit_of(2), 0U);
    EXPECT_EQ(c.bits(c.cell(cell)[0]), tetmesh::bit_of(2)) << "the tip's own material is gone from its apex";
  }
}

TEST(RelabelTip, NotWhereANodeIsFrozen) {
  auto [c, cell] = tip_between(1);
  ASSERT_GE(cell, 0);
  c.frozen.assign(c.nodes_mm.size(), 0);
  c.frozen[static_cast<std::size_t>(c.cell(cell)[2])] = 1;
  EXPECT_FALSE(tetmesh::relabel_spike(c, cell)) << "cells beyond a place that was cut out are not seen";
  EXPECT_EQ(c.label_of(cell), 1);
}

TEST(RelabelTip, NotWhereAMaterialWouldBeJoinedOrParted) {
  auto [c, cell] = tip_between(3);
  ASSERT_GE(cell, 0);
  // The first wedge's material is also at the apex: together with material 1 it makes a ring through the cell.
  for (const auto t : c.star(c.cell(cell)[0])) {
    int shared = 0;
    for (const auto n : c.cell(t)) shared += tetmesh::has(c.cell(cell), n) ? 1 : 0;
    if (shared == 1) c.label[static_cast<std::size_t>(t)] = 3;
  }
  EXPECT_FALSE(tetmesh::relabel_spike(c, cell));
  EXPECT_EQ(c.label_of(cell), 1);
}

TEST(Relabel, OnlyToALabelOfTheNeighbours) {
  auto [c, cell] = tip_between(1);
  ASSERT_GE(cell, 0);
  EXPECT_FALSE(tetmesh::relabel(c, cell, 9)) << "it would be an island";
  EXPECT_TRUE(tetmesh::relabel(c, cell, 2));
  EXPECT_EQ(c.label_of(cell), 2);
}

// A ball of one material reaches the outside in an edge of a cell: as another material, which its neighbour is, the
// cell would part the ball there.
TEST(Relabel, NotWhereTheMaterialWouldBePartedAtTheOutside) {
  const auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 6, 1);
  auto whole = stuffing::stuff_isosurfaces(m, {});
  tetmesh::derive_touches(whole);
  tetmesh::compress(whole);
  std::fill(whole.label.begin(), whole.label.end(), std::uint8_t{2});
  for (auto& bits : whole.touches) bits = (bits & tetmesh::bit_of(0)) | tetmesh::bit_of(2);
  const auto is_outer = [&](std::int32_t n) { return (whole.bits(n) & tetmesh::bit_of(0)) != 0; };
  int at_edges = 0, inside = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(whole.cells.size()); ++t) {
    const Cell cell = whole.cell(t);
    const auto outer_nodes = std::count_if(cell.begin(), cell.end(), is_outer);
    if (outer_nodes != 0 && outer_nodes != 2) continue;
    // The neighbour beyond the face that lacks an outer node, if there is one.
    const auto corner =
        outer_nodes == 0 ? 0U : static_cast<std::size_t>(std::ranges::find_if(cell, is_outer) - cell.begin());
    const auto pair =
        tetmesh::cells_at_face(whole, cell[(corner + 1) % 4], cell[(corner + 2) % 4], cell[(corner + 3) % 4]);
    if (pair[1] < 0) continue;
    auto c = whole;
    const auto neighbour = pair[0] == t ? pair[1] : pair[0];
    c.label[static_cast<std::size_t>(neighbour)] = 1;
    for (const auto n : c.cell(neighbour)) c.touches[static_cast<std::size_t>(n)] |= tetmesh::bit_of(1);
    const bool is_done = tetmesh::relabel(c, t, 1);
    if (outer_nodes == 0) {
      ++inside;
      EXPECT_TRUE(is_done) << t;
    } else {
      std::array<std::int32_t, 2> ends{};
      std::copy_if(cell.begin(), cell.end(), ends.begin(), is_outer);
      if (!tetmesh::ring_around(whole, ends[0], ends[1]).is_open) continue;
      ++at_edges;
      EXPECT_FALSE(is_done) << t;
    }
  }
  EXPECT_GT(at_edges, 0);
  EXPECT_GT(inside, 0);
}

TEST(Relabel, CellsGoToTheOutsideOneByOneAndTheSurfaceStaysClosed) {
  const auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 6, 1);
  auto c = stuffing::stuff_isosurfaces(m, {});
  tetmesh::derive_touches(c);
  tetmesh::compress(c);
  const auto count = static_cast<std::int32_t>(c.cells.size());
  int gone = 0;
  for (std::int32_t t = 0; t < count; t += 3) {
    const Cell cell = c.cell(t);
    const auto is_outer = [&](std::int32_t n) { return (c.bits(n) & tetmesh::bit_of(0)) != 0; };
    const bool is_inner = std::none_of(cell.begin(), cell.end(), is_outer);
    const bool is_gone = tetmesh::relabel(c, t, 0);
    EXPECT_FALSE(is_inner && is_gone) << "it would be a bubble";
    EXPECT_EQ(c.is_alive(t), !is_gone);
    if (!is_gone) continue;
    ++gone;
    for (const auto n : cell) EXPECT_TRUE(is_outer(n) || c.star(n).empty());
  }
  EXPECT_GT(gone, count / 30);
  EXPECT_GT(min_volume(c), 0);
  EXPECT_EQ(defects(c), 0);
}

TEST(Relabel, NotWhereMoreMaterialsMeetThanAreLookedAt) {
  auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 7, 1);
  auto c = stuffing::stuff_isosurfaces(m, {});
  tetmesh::compress(c);
  for (std::size_t t = 0; t < c.cells.size(); ++t) c.label[t] = static_cast<std::uint8_t>(1 + t % 20);
  tetmesh::derive_touches(c);
  int looked_at = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(c.cells.size()); ++t) {
    if (!is_deep_inside(c, t)) continue;
    ++looked_at;
    EXPECT_FALSE(tetmesh::relabel(c, t, c.label_of(t) % 20 + 1)) << t;
  }
  EXPECT_GT(looked_at, 0);
}

TEST(PierceFace, PutsANodeOnTheSurfaceBehindTheMiddle) {
  const auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 7, 2);
  auto c = stuffing::stuff_isosurfaces(m, {});
  tetmesh::derive_touches(c);
  tetmesh::compress(c);
  const auto faces = tetmesh::surface_faces(c);
  ASSERT_GT(faces.size(), 50U);
  const double volume = volume_of(c, 1);
  const auto count = c.cells.size();
  const auto node = tetmesh::split_face(c, m, faces[7].nodes);
  ASSERT_GE(node, 0);
  EXPECT_NEAR(norm(c.at(node)), 5, 0.01);
  EXPECT_EQ(c.bits(node), tetmesh::bit_of(0) | tetmesh::bit_of(1));
  EXPECT_EQ(c.star(node).size(), 3U);
  tetmesh::compress(c);
  EXPECT_EQ(c.cells.size(), count + 2);
  EXPECT_GT(volume_of(c, 1), volume) << "a ball is convex: its surface lies beyond the middles of faces";
  EXPECT_GT(min_volume(c), 0);
  EXPECT_EQ(defects(c), 0);
}

TEST(PierceFace, LeavesAFaceFarFromItsSurface) {
  const auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 7, 2);
  auto c = stuffing::stuff_isosurfaces(m, {});
  tetmesh::derive_touches(c);
  tetmesh::compress(c);
  const auto nodes = c.nodes_mm.size();
  const auto far = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 50 - norm(p); }}, 7, 2);
  EXPECT_LT(tetmesh::split_face(c, far, tetmesh::surface_faces(c)[7].nodes), 0);
  EXPECT_EQ(c.nodes_mm.size(), nodes);
}

// Not for the sake of the worst cell: any edge goes where the mesh stays whole.
TEST(ShrinkEdge, TheMeshStaysWholeAndItsSurfaceClosed) {
  const auto m = ball_of_two_halves();
  auto c = mesh_of(m).complex;
  const auto cells = c.cells.size();
  const auto edge_of = [&](std::size_t t) { return std::pair{c.cells[t][0], c.cells[t][1]}; };
  int shrunk = 0, on_surface = 0;
  for (std::size_t t = 0; t < cells; t += 60) {
    if (!c.is_alive(static_cast<std::int32_t>(t))) continue;
    const auto [a, b] = edge_of(t);
    const LabelBits gone = c.bits(b);
    const bool may = (gone & ~c.bits(a)) == 0;
    const bool is_shrunk = tetmesh::shrink_edge(c, m, a, b);
    EXPECT_TRUE(may || !is_shrunk);
    if (!is_shrunk) continue;
    EXPECT_TRUE(c.star(b).empty());
    ++shrunk;
    on_surface += tetmesh::is_constrained(gone) ? 1 : 0;
  }
  EXPECT_GT(shrunk, 20);
  EXPECT_GT(on_surface, 2);
  EXPECT_GT(min_volume(c), 0);
  EXPECT_EQ(defects(c), 0);
}

TEST(ShrinkEdge, FrozenNodesStay) {
  const auto m = ball_of_two_halves();
  auto c = mesh_of(m).complex;
  c.frozen.assign(c.nodes_mm.size(), 1);
  for (std::size_t t = 0; t < c.cells.size(); t += 60)
    EXPECT_FALSE(tetmesh::shrink_edge(c, m, c.cells[t][0], c.cells[t][1]));
}

}  // namespace
