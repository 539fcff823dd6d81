// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/sort_cells.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"

namespace heartgen::mesh {

void sort_cells(const std::vector<Vec3>& nodes_mm, std::vector<Cell>& cells, std::vector<std::int32_t>& label) {
  using Labelled = std::pair<Cell, std::int32_t>;
  parallel::parallel_for(0, static_cast<std::int64_t>(cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
      Cell& cell = cells[c];
      std::sort(cell.begin(), cell.end());
      const auto p = [&](std::size_t i) { return nodes_mm[static_cast<std::size_t>(cell[i])]; };
      if (dot(p(1) - p(0), cross(p(2) - p(0), p(3) - p(0))) < 0) std::swap(cell[2], cell[3]);
    }
  });
  // Few cells have the same first node: in its place, each node's cells are sorted by themselves.
  const auto of_nodes = [&](std::int64_t first, std::int64_t last, std::vector<Labelled>& sorted) {
    std::vector<std::size_t> end(static_cast<std::size_t>(last - first) + 1, 0);
    const auto each = [&](const auto& visit) {
      for (std::size_t c = 0; c < cells.size(); ++c)
        if (const auto node = cells[c][0]; node >= first && node < last)
          visit(static_cast<std::size_t>(node - first), c);
    };
    each([&](std::size_t node, std::size_t) { ++end[node + 1]; });
    std::partial_sum(end.begin(), end.end(), end.begin());
    sorted.resize(end.back());
    each([&](std::size_t node, std::size_t c) { sorted[end[node]++] = {cells[c], label[c]}; });
    auto begin = sorted.begin();
    for (std::size_t node = 0; node + 1 < end.size(); ++node) {
      const auto stop = sorted.begin() + static_cast<std::ptrdiff_t>(end[node]);
      std::sort(begin, stop);
      begin = stop;
    }
  };
  const auto sorted = parallel::gather<Labelled>(0, static_cast<std::int64_t>(nodes_mm.size()), of_nodes);
  for (std::size_t c = 0; c < cells.size(); ++c) std::tie(cells[c], label[c]) = sorted[c];
}

}  // namespace heartgen::mesh
