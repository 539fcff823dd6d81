// The cells around every node, collected by several threads.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "model/tet_mesh.hpp"

namespace heart::lattice {

/// Calls visit(node, cell) for each corner of each cell; those of one node come in the order of the cells, and from one
/// thread. (Threads share the nodes: each looks at all cells, and visits what concerns its nodes.) Corners that are not
/// in [0, node_count) are passed over.
template <class Visit>
void visit_stars(std::size_t node_count, std::span<const Cell> cells, Visit&& visit) {
  parallel::parallel_for(0, static_cast<std::int64_t>(node_count), [&](std::int64_t begin, std::int64_t end, int) {
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (const auto n : cells[c])
        if (n >= begin && n < end) visit(static_cast<std::size_t>(n), static_cast<std::int32_t>(c));
  });
}

/// The cells of each node, ascending.
struct Stars {
  std::vector<std::int32_t> first;  ///< per node, and one more: where its cells begin
  std::vector<std::int32_t> cells;
  std::span<const std::int32_t> of(std::int32_t node) const {
    const auto n = static_cast<std::size_t>(node);
    return {cells.data() + first[n], static_cast<std::size_t>(first[n + 1] - first[n])};
  }
};

Stars stars_of(std::size_t node_count, std::span<const Cell> cells);

}  // namespace heart::lattice
