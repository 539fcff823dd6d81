// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes on the curves where three materials meet.
#include "generator/surface_fit/feature_projection.hpp"

#include <gtest/gtest.h>

#include <bit>

#include "generator/tetmesh/feature.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

/// Three sectors around a bent line.
Materials sectors() {
  const auto bend = [](const Vec3& p) { return 0.5 * std::sin(p.z / 3); };
  const Fields fields{[](const Vec3&) { return -100.0; }, [=](const Vec3& p) { return p.x - bend(p); },
                      [=](const Vec3& p) { return -0.5 * (p.x - bend(p)) + 0.8 * p.y; },
                      [=](const Vec3& p) { return -0.5 * (p.x - bend(p)) - 0.8 * p.y; }};
  return materials_of(fields, 8, 1.5);
}

Complex stuffed(const Materials& m) {
  auto c = stuffing::stuff_isosurfaces(m, {});
  tetmesh::derive_touches(c);
  tetmesh::compress(c);
  return c;
}

std::vector<std::int32_t> nodes_on_curve(const Complex& c) {
  std::vector<std::int32_t> nodes;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(c.nodes_mm.size()); ++n)
    if (std::popcount(c.bits(n) & ~tetmesh::side_bits) > 2) nodes.push_back(n);
  return nodes;
}

double farthest(const Complex& c, const Materials& m) {
  double distance = 0;
  for (const auto n : nodes_on_curve(c))
    distance = std::max(distance, norm(tetmesh::project(m, c.bits(n), c.at(n), 8) - c.at(n)));
  return distance;
}

TEST(Draw, NodesBesideTheirCurveComeBack) {
  const auto m = sectors();
  auto c = stuffed(m);
  const auto nodes = nodes_on_curve(c);
  ASSERT_GT(nodes.size(), 8U);
  int pushed = 0;
  for (const auto n : nodes) {
    const Vec3 before = c.at(n);
    if ((c.bits(n) & tetmesh::side_bits) == 0) tetmesh::shift_node(c, n, {0.35, -0.2, 0}, 1, 0.1);
    pushed += norm(c.at(n) - before) > 0;
  }
  ASSERT_GT(pushed, 4);
  ASSERT_GT(farthest(c, m), 0.3);
  const double worst = *std::ranges::min_element(c.quality);
  surface_fit::project_to_curves(c, m, 0.05);
  EXPECT_LT(farthest(c, m), 0.05);
  EXPECT_GE(static_cast<double>(*std::ranges::min_element(c.quality)), std::min(0.05, worst));
}

TEST(Draw, FrozenNodesStay) {
  const auto m = sectors();
  auto c = stuffed(m);
  for (const auto n : nodes_on_curve(c)) tetmesh::shift_node(c, n, {0.3, 0, 0}, 1, 0.1);
  c.frozen.assign(c.nodes_mm.size(), 1);
  const auto before = c.nodes_mm;
  surface_fit::project_to_curves(c, m, 0.05);
  EXPECT_EQ(c.nodes_mm, before);
}

}  // namespace
