// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/stars.hpp"

#include <gtest/gtest.h>

#include <random>

#include "generator/parallel/threads.hpp"

namespace heartgen::tetmesh {
namespace {

// Corners of dead cells (-1) and of nodes beyond the last one are in no star.
TEST(Stars, AreTheCellsOfEachNodeAscending) {
  constexpr std::int32_t nodes = 90;
  std::mt19937_64 random(5);
  std::uniform_int_distribution<std::int32_t> node(-1, nodes + 3);
  std::vector<Cell> cells(700);
  std::vector<std::vector<std::int32_t>> expected(nodes);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (auto& n : cells[c]) {
      n = node(random);
      if (n >= 0 && n < nodes) expected[static_cast<std::size_t>(n)].push_back(static_cast<std::int32_t>(c));
    }
  for (const int threads : {1, 2, 3, 11}) {
    parallel::set_thread_count(threads);
    const auto stars = tetmesh::stars_of(nodes, cells);
    for (std::int32_t n = 0; n < nodes; ++n) {
      const auto star = stars.of(n);
      EXPECT_EQ(std::vector(star.begin(), star.end()), expected[static_cast<std::size_t>(n)]) << threads << ", " << n;
    }
  }
  parallel::set_thread_count(2);
}

TEST(Stars, OfNoCellsAreEmpty) { EXPECT_TRUE(tetmesh::stars_of(3, {}).of(2).empty()); }

}  // namespace
}  // namespace heartgen::tetmesh
