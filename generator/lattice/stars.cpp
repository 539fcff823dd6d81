#include "generator/lattice/stars.hpp"

namespace heart::lattice {

Stars stars_of(std::size_t node_count, std::span<const Cell> cells) {
  Stars stars;
  stars.first.assign(node_count + 1, 0);
  visit_stars(node_count, cells, [&](std::size_t n, std::int32_t) { ++stars.first[n + 1]; });
  for (std::size_t n = 0; n < node_count; ++n) stars.first[n + 1] += stars.first[n];
  stars.cells.resize(static_cast<std::size_t>(stars.first.back()));
  auto next = stars.first;
  visit_stars(node_count, cells,
              [&](std::size_t n, std::int32_t c) { stars.cells[static_cast<std::size_t>(next[n]++)] = c; });
  return stars;
}

}  // namespace heart::lattice
