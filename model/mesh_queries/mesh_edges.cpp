// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mesh_queries/mesh_edges.hpp"

#include <algorithm>

#include "model/sort_unique.hpp"

namespace heartgen::mesh_queries {
namespace {

template <class Visit>
void for_edges(const std::vector<Cell>& cells, const std::vector<std::uint8_t>& use, Visit&& visit) {
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!use.empty() && !use[c]) continue;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b)
        visit(std::min(cells[c][a], cells[c][b]), std::max(cells[c][a], cells[c][b]));
  }
}

}  // namespace

std::vector<NodePair> edges_of_cells(const std::vector<Cell>& cells, std::size_t node_count,
                                     const std::vector<std::uint8_t>& use) {
  // The larger nodes, grouped by the smaller one: short lists, quickly sorted.
  std::vector<std::size_t> start(node_count + 1);
  for_edges(cells, use, [&](std::int32_t a, std::int32_t) { ++start[static_cast<std::size_t>(a) + 1]; });
  for (std::size_t n = 1; n < start.size(); ++n) start[n] += start[n - 1];
  std::vector<std::int32_t> larger(start.back());
  auto next = start;
  for_edges(cells, use, [&](std::int32_t a, std::int32_t b) { larger[next[static_cast<std::size_t>(a)]++] = b; });
  std::vector<NodePair> edges;
  std::vector<std::int32_t> ends;
  for (std::size_t n = 0; n < node_count; ++n) {
    ends.assign(larger.begin() + static_cast<std::ptrdiff_t>(start[n]),
                larger.begin() + static_cast<std::ptrdiff_t>(start[n + 1]));
    sort_unique(ends);
    for (const auto b : ends) edges.push_back({static_cast<std::int32_t>(n), b});
  }
  return edges;
}

}  // namespace heartgen::mesh_queries
