// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/complex.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "generator/parallel/threads.hpp"
#include "generator/surface_fit/self_intersections.hpp"
#include "generator/tetmesh/collapse.hpp"
#include "generator/tetmesh/quality.hpp"
#include "generator/tetmesh/ring.hpp"
#include "generator/tetmesh/surface_faces.hpp"
#include "support/places.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

// `count` cells around the edge from node 0 to node 1, closed.
Complex wheel(int count) {
  Complex c;
  c.nodes_mm = {{0, 0, -1}, {0, 0, 1}};
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    c.nodes_mm.push_back({std::cos(angle), std::sin(angle), 0});
  }
  for (int i = 0; i < count; ++i) c.cells.push_back({0, 1, 2 + i, 2 + (i + 1) % count});
  c.touches.assign(c.nodes_mm.size(), 0);
  c.spacing_mm.assign(c.nodes_mm.size(), 1);
  c.label.assign(c.cells.size(), 1);
  tetmesh::connect(c);
  return c;
}

TEST(Quality, OfSeveralAtOnceHasTheSameBits) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  int inverted = 0;
  for (int round = 0; round < 500; ++round) {
    tetmesh::CellBatch batch;
    std::array<std::array<Vec3, 4>, tetmesh::CellBatch::size> cells;
    for (std::size_t cell = 0; cell < cells.size(); ++cell)
      for (std::size_t corner = 0; corner < 4; ++corner) {
        auto& p = cells[cell][corner] = {coordinate(random), coordinate(random), coordinate(random)};
        if (round % 10 == 0) p.z = 0;  // flat
        batch.set(cell, corner, p);
      }
    const auto quality = tetmesh::cell_qualities(batch);
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      const auto& p = cells[cell];
      EXPECT_EQ(quality[cell], tetmesh::cell_quality(p[0], p[1], p[2], p[3]));
      inverted += quality[cell] < 0;
    }
  }
  EXPECT_GT(inverted, 100);
}

TEST(Quality, RegularFlatAndInvertedCells) {
  const Vec3 a{1, 1, 1}, b{1, -1, -1}, c{-1, 1, -1}, d{-1, -1, 1};
  EXPECT_NEAR(tetmesh::cell_quality(b, a, c, d), tetmesh::obtuse_weight, 1e-12) << "nothing acute below: the cap";
  EXPECT_LT(tetmesh::cell_quality(a, b, c, d), 0);
  EXPECT_NEAR(tetmesh::cell_quality({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}), 0, 1e-8);
}

TEST(Quality, IsTheWorstWeightedSineOfTheDihedralAngles) {
  std::mt19937 random(7);
  const auto number = [&] { return static_cast<double>(random() % 2001) / 1000 - 1; };
  for (int round = 0; round < 200; ++round) {
    std::array<Vec3, 4> p;
    for (auto& q : p) q = {number(), number(), number()};
    if (dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0])) < 0) std::swap(p[2], p[3]);
    double worst = tetmesh::obtuse_weight;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        std::size_t k = 0;
        while (k == i || k == j) ++k;
        const std::size_t l = 6 - i - j - k;
        const Vec3 along = normalized(p[j] - p[i]);
        const auto across = [&](std::size_t to) {
          const Vec3 v = p[to] - p[i];
          return normalized(v - dot(v, along) * along);
        };
        const double angle = std::acos(std::clamp(dot(across(k), across(l)), -1.0, 1.0));
        const bool obtuse = angle > 0.5 * std::numbers::pi;
        worst = std::min(worst, (obtuse ? tetmesh::obtuse_weight : 1) * std::sin(angle));
      }
    EXPECT_NEAR(tetmesh::cell_quality(p[0], p[1], p[2], p[3]), worst, 1e-6);
  }
}

TEST(Complex, OthersMakeAPositiveCell) {
  const Cell cell{10, 11, 12, 13};
  std::map<std::int32_t, Vec3> p{{10, {0, 0, 0}}, {11, {1, 0, 0}}, {12, {0, 1, 0}}, {13, {0, 0, 1}}};
  for (const auto a : cell)
    for (const auto b : cell) {
      if (a == b) continue;
      const auto [c, d] = tetmesh::others(cell, a, b);
      EXPECT_GT(dot(p[b] - p[a], cross(p[c] - p[a], p[d] - p[a])), 0) << a << " " << b;
    }
}

TEST(Complex, RingOfAnInnerAndOfAnOuterEdge) {
  const auto c = wheel(6);
  const auto ring = tetmesh::ring_around(c, 0, 1);
  EXPECT_EQ(ring.size, 6U);
  EXPECT_FALSE(ring.is_open);
  EXPECT_EQ(ring.arc_count, 1U);
  const auto outer = tetmesh::ring_around(c, 0, 2);
  EXPECT_EQ(outer.size, 2U);
  EXPECT_TRUE(outer.is_open);
}

TEST(Complex, RingStartsWhereALabelStarts) {
  auto c = wheel(7);
  for (const std::size_t i : {2U, 3U, 4U}) c.label[i] = 2;
  const auto ring = tetmesh::ring_around(c, 0, 1);
  ASSERT_EQ(ring.arc_count, 2U);
  const int first = c.label_of(ring.cells[0]);
  for (std::size_t i = 0; i < ring.size; ++i)
    EXPECT_EQ(c.label_of(ring.cells[i]), i < ring.arcs[1] ? first : 3 - first);
}

TEST(Complex, StarsFollowAddedAndRemovedCells) {
  auto c = wheel(5);
  for (int round = 0; round < 3; ++round)
    for (int i = 0; i < 5; ++i) {
      const Cell cell = c.cell(i);
      tetmesh::remove_cell(c, i);
      EXPECT_EQ(c.star(0).size(), 4U);
      EXPECT_EQ(tetmesh::add_cell(c, cell, 1), i) << "free places are used again";
    }
  EXPECT_EQ(c.star(0).size(), 5U);
  for (std::int32_t n = 2; n < 7; ++n) EXPECT_EQ(c.star(n).size(), 2U);
}

// Two cells whose tips point at each other; they overlap by `overlap`.
Complex two_tips(double overlap) {
  Complex c;
  for (const double sign : {1.0, -1.0}) {
    const Vec3 shift{sign > 0 ? 0.0 : 0.05, sign > 0 ? 0.0 : 0.03, sign > 0 ? 0.0 : 2 - overlap};
    for (const Vec3& p : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{-0.5, 0.9, 0}, Vec3{-0.5, -0.9, 0}})
      c.nodes_mm.push_back(shift + Vec3{p.x, p.y, sign * p.z});
  }
  c.cells = {{0, 1, 3, 2}, {4, 5, 6, 7}};
  c.touches.assign(8, tetmesh::bit_of(0) | tetmesh::bit_of(1));
  c.spacing_mm.assign(8, 1);
  c.label.assign(2, 1);
  tetmesh::connect(c);
  return c;
}

bool is_inside(const Complex& c, const Cell& cell, const Vec3& p) {
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<Vec3, 4> q{c.at(cell[0]), c.at(cell[1]), c.at(cell[2]), c.at(cell[3])};
    q[i] = p;
    if (dot(q[1] - q[0], cross(q[2] - q[0], q[3] - q[0])) < 0) return false;
  }
  return true;
}

int points_in_both(const Complex& c) {
  int count = 0;
  for (const double x : heartgen::testing::steps(-0.3, 0.3, 0.01))
    for (const double y : heartgen::testing::steps(-0.3, 0.3, 0.01))
      for (const double z : heartgen::testing::steps(0.7, 1.1, 0.01))
        count += is_inside(c, c.cells[0], {x, y, z}) && is_inside(c, c.cells[1], {x, y, z});
  return count;
}

// Balls of cells, enough for several threads.
Complex stuffed_ball() {
  auto c = stuffing::stuff_isosurfaces(
      materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 9 - norm(p); }}, 11, 0.7), {});
  tetmesh::derive_touches(c);
  tetmesh::compress(c);
  return c;
}

TEST(Complex, DroppingKeepsOrderPlacesAndQualities) {
  auto c = stuffed_ball();
  ASSERT_GT(c.cells.size(), 40'000U);
  std::mt19937 random(3);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(c.cells.size()); ++t)
    if (const auto kind = random() % 4; kind == 0)
      tetmesh::remove_cell(c, t);
    else if (kind == 1)
      c.label[static_cast<std::size_t>(t)] = 0;
  std::vector<std::array<Vec3, 4>> places;
  std::vector<float> qualities;
  for (std::size_t t = 0; t < c.cells.size(); ++t) {
    const Cell& cell = c.cells[t];
    if (cell[0] < 0 || c.label[t] == 0) continue;
    places.push_back({c.at(cell[0]), c.at(cell[1]), c.at(cell[2]), c.at(cell[3])});
    qualities.push_back(c.quality[t]);
  }
  const int threads = parallel::thread_count();
  for (const int count : {1, 2, 3}) {
    parallel::set_thread_count(count);
    auto dropped = c;
    tetmesh::drop_unused(dropped);
    ASSERT_EQ(dropped.cells.size(), places.size());
    EXPECT_EQ(dropped.quality, qualities);
    std::vector<std::uint8_t> is_used(dropped.nodes_mm.size(), 0);
    for (std::size_t t = 0; t < places.size(); ++t)
      for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(dropped.at(dropped.cells[t][i]), places[t][i]);
        is_used[static_cast<std::size_t>(dropped.cells[t][i])] = 1;
      }
    EXPECT_EQ(std::count(is_used.begin(), is_used.end(), 0), 0);
  }
  parallel::set_thread_count(threads);
}

TEST(SurfaceFaces, RenewedOnesAreThoseOfANewSearch) {
  auto c = stuffed_ball();
  const auto m = materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 9 - norm(p); }}, 11, 0.7);
  auto faces = tetmesh::surface_faces(c);
  std::vector<std::int32_t> changed;
  for (std::size_t f = 0; f < faces.size(); f += 500) {
    const auto a = faces[f].nodes[0], b = faces[f].nodes[1];
    const auto node = tetmesh::bisect_edge(c, m, a, b);
    if (node < 0) continue;
    changed.push_back(node);
    for (const auto t : c.star(node)) changed.insert(changed.end(), c.cell(t).begin(), c.cell(t).end());
  }
  ASSERT_GT(changed.size(), 50U);
  tetmesh::renew_faces(faces, c, changed);
  const auto sorted = [](const std::vector<tetmesh::SurfaceFace>& list) {
    std::vector<std::pair<Face, LabelBits>> result;
    for (auto face : list) {
      std::sort(face.nodes.begin(), face.nodes.end());
      result.emplace_back(face.nodes, face.labels);
    }
    std::sort(result.begin(), result.end());
    return result;
  };
  EXPECT_EQ(sorted(faces), sorted(tetmesh::surface_faces(c)));
}

TEST(Separate, SheetsThatPassThroughEachOtherAreDrawnBack) {
  auto c = two_tips(0.15);
  ASSERT_GT(min_volume(c), 0);
  ASSERT_GT(points_in_both(c), 10);
  EXPECT_EQ(surface_fit::resolve_self_intersections(c, 0.1), 0);
  EXPECT_EQ(points_in_both(c), 0);
  for (const auto& cell : c.cells) EXPECT_GT(tetmesh::quality(c, cell), 0.1);
}

TEST(Separate, WhatDoesNotMeetStays) {
  auto c = two_tips(-0.05);
  const auto before = c.nodes_mm;
  EXPECT_EQ(surface_fit::resolve_self_intersections(c, 0.1), 0);
  for (std::size_t n = 0; n < before.size(); ++n) EXPECT_EQ(norm(c.nodes_mm[n] - before[n]), 0);
}

// Two balls of small cells that overlap by more than their outer cells can give way.
TEST(Separate, CellsThatCannotBeDrawnBackGo) {
  const auto ball =
      mesh_of(materials_of({[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return 5 - norm(p); }}, 6, 1)).complex;
  Complex c = ball;
  const auto nodes = static_cast<std::int32_t>(ball.nodes_mm.size());
  for (const auto& p : ball.nodes_mm) c.nodes_mm.push_back(p + Vec3{9.1, 0.2, 0.1});
  for (auto cell : ball.cells) {
    for (auto& n : cell) n += nodes;
    c.cells.push_back(cell);
  }
  c.touches.insert(c.touches.end(), ball.touches.begin(), ball.touches.end());
  c.spacing_mm.insert(c.spacing_mm.end(), ball.spacing_mm.begin(), ball.spacing_mm.end());
  c.label.insert(c.label.end(), ball.label.begin(), ball.label.end());
  tetmesh::connect(c);
  const auto meeting = [&] {
    return surface_fit::self_intersecting_faces(c.nodes_mm, surface_fit::outer_faces(c)).size();
  };
  ASSERT_GT(meeting(), 10U);
  auto gently = c;
  ASSERT_GT(surface_fit::resolve_self_intersections_gently(gently, 0.4885), 0);
  EXPECT_EQ(surface_fit::resolve_self_intersections(c, 0.4885), 0);
  EXPECT_EQ(meeting(), 0U);
  EXPECT_GT(min_volume(c), 0);
  EXPECT_EQ(defects(c), 0);
}

TEST(Separate, FrozenNodesStayAndTheirPairsAreCounted) {
  auto c = two_tips(0.15);
  c.frozen.assign(8, 1);
  EXPECT_GT(surface_fit::resolve_self_intersections(c, 0.1), 0);
  EXPECT_GT(points_in_both(c), 10);
}

}  // namespace
