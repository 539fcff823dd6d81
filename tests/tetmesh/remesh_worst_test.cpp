// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/remesh_worst.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "generator/parallel/threads.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

constexpr double enough = 0.53;  // quality

Materials ball() {
  return materials_of({[](const Vec3&) { return 0.0; },
                       [](const Vec3& p) {
                         return 6 - norm(p - Vec3{0.1, 0.2, 0.3});
                       }},
                      8, 1.2);
}

tetmesh::RepairSettings aims() {
  tetmesh::RepairSettings settings;
  settings.goal = 0.54;
  return settings;
}

// Hardly repaired: some cells at the surface are bad.
Complex bad_ball(const Materials& materials) {
  auto settings = aims();
  settings.sweeps = 1;
  return mesh_of(materials, settings).complex;
}

std::vector<std::size_t> cells_below(const Complex& c) {
  std::vector<std::size_t> bad;
  for (std::size_t i = 0; i < c.quality.size(); ++i)
    if (static_cast<double>(c.quality[i]) < enough) bad.push_back(i);
  return bad;
}

double worst_of(const Complex& c) { return static_cast<double>(*std::min_element(c.quality.begin(), c.quality.end())); }

TEST(Rescue, BadCellsAreMendedAndTheMeshStaysWhole) {
  const auto m = ball();
  auto c = bad_ball(m);
  const double volume = volume_of(c, 1);
  ASSERT_GT(cells_below(c).size(), 3U);
  EXPECT_EQ(tetmesh::remesh_worst(c, m, aims(), enough, tetmesh::OnFailure::stop), 0);
  EXPECT_EQ(cells_below(c).size(), 0U);
  tetmesh::compress(c);
  EXPECT_EQ(defects(c), 0);
  EXPECT_GT(min_volume(c), 0);
  EXPECT_NEAR(volume_of(c, 1), volume, 0.01 * volume);
}

TEST(Rescue, FrozenNodesStayAndNothingGetsWorse) {
  const auto m = ball();
  auto c = bad_ball(m);
  c.frozen.assign(c.nodes_mm.size(), 1);
  const auto before = c.nodes_mm;
  const double worst = worst_of(c);
  tetmesh::remesh_worst(c, m, aims(), enough, tetmesh::OnFailure::go_on);
  EXPECT_GE(worst_of(c), worst);
  for (std::size_t n = 0; n < before.size(); ++n) EXPECT_EQ(norm(c.nodes_mm[n] - before[n]), 0) << n;
}

TEST(Rescue, SameBitsForAnyNumberOfThreads) {
  const auto m = ball();
  std::vector<std::vector<Vec3>> nodes;
  std::vector<std::vector<Cell>> cells;
  for (const int threads : {1, 2, 3}) {
    parallel::set_thread_count(threads);
    auto c = bad_ball(m);
    tetmesh::remesh_worst(c, m, aims(), enough, tetmesh::OnFailure::stop);
    nodes.push_back(c.nodes_mm);
    cells.push_back(c.cells);
  }
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    EXPECT_EQ(cells[i], cells[0]);
    ASSERT_EQ(nodes[i].size(), nodes[0].size());
    EXPECT_EQ(std::memcmp(nodes[i].data(), nodes[0].data(), nodes[0].size() * sizeof(Vec3)), 0);
  }
}

}  // namespace
