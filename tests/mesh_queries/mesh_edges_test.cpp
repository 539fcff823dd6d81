// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mesh_queries/mesh_edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace heartgen {
namespace {

/// Cells of four different nodes, from a linear congruential generator.
std::vector<Cell> some_cells(std::size_t count, std::int32_t nodes) {
  std::uint32_t state = 12345;
  std::vector<Cell> cells;
  while (cells.size() < count) {
    Cell cell;
    for (auto& node : cell) {
      state = 1664525U * state + 1013904223U;
      node = static_cast<std::int32_t>((state >> 8) % static_cast<std::uint32_t>(nodes));
    }
    if (std::set<std::int32_t>(cell.begin(), cell.end()).size() == 4) cells.push_back(cell);
  }
  return cells;
}

TEST(MeshEdges, AreThoseOfASetOfPairs) {
  constexpr std::int32_t nodes = 40;
  const auto cells = some_cells(60, nodes);
  std::vector<std::uint8_t> use(cells.size());
  for (std::size_t c = 0; c < use.size(); ++c) use[c] = c % 3 != 0;
  for (const auto& chosen : {std::vector<std::uint8_t>{}, use}) {
    std::set<mesh_queries::NodePair> expected;
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (const auto a : cells[c])
        for (const auto b : cells[c])
          if (a < b && (chosen.empty() || chosen[c])) expected.insert({a, b});
    EXPECT_EQ(mesh_queries::edges_of_cells(cells, nodes, chosen),
              std::vector<mesh_queries::NodePair>(expected.begin(), expected.end()));
  }
}

}  // namespace
}  // namespace heartgen
