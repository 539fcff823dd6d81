// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/slabs.hpp"

#include <gtest/gtest.h>

#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

Complex long_rod() {
  const auto m = materials_of({[](const Vec3&) { return 0.0; },
                               [](const Vec3& p) {
                                 return 3 - norm(Vec3{0.2 * p.x, p.y, p.z});
                               }},
                              16, 1);
  auto c = stuffing::stuff_isosurfaces(m, {});
  tetmesh::derive_touches(c);
  tetmesh::compress(c);
  return c;
}

TEST(Slabs, CellsReachFromASlabToItsNeighboursOnly) {
  const auto c = long_rod();
  const auto slabs = tetmesh::slabs_across(c, 1, 100);
  EXPECT_EQ(slabs.axis, 0);
  EXPECT_GT(slabs.count, 4U);
  for (const auto& cell : c.cells)
    for (const auto a : cell)
      for (const auto b : cell) {
        const auto of_a = slabs.of(c.at(a)), of_b = slabs.of(c.at(b));
        ASSERT_LE(std::max(of_a, of_b) - std::min(of_a, of_b), 1U);
        ASSERT_LT(of_a, slabs.count);
      }
}

TEST(Slabs, AreNoMoreThanWanted) {
  const auto c = long_rod();
  for (const std::size_t most : {0U, 1U, 2U, 3U}) EXPECT_LE(tetmesh::slabs_across(c, 1, most).count, most + 1);
  EXPECT_EQ(tetmesh::slabs_across({}, 1, 5).count, 1U);
}

TEST(Slabs, EachItemIsWorkedOnOnceInItsTurn) {
  const auto c = long_rod();
  const auto slabs = tetmesh::slabs_across(c, 2, 100);
  std::vector<std::vector<std::size_t>> done(slabs.count);
  tetmesh::for_slabs(
      slabs, c.nodes_mm.size(), [&](std::size_t i) { return c.nodes_mm[i]; },
      [&](std::size_t i) { done[slabs.of(c.nodes_mm[i])].push_back(i); });
  std::size_t count = 0;
  for (const auto& of_slab : done) {
    EXPECT_TRUE(std::is_sorted(of_slab.begin(), of_slab.end()));
    count += of_slab.size();
  }
  EXPECT_EQ(count, c.nodes_mm.size());
}

}  // namespace
