// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/stars.hpp"

#include <algorithm>
#include <utility>

#include "generator/parallel/threads.hpp"

namespace heartgen::tetmesh {
namespace {

constexpr std::int64_t max_pieces = 8;  // each has a number for every node

// Calls visit(number, cell) for each corner with the number of its node in the piece to which the cell belongs.
template <class Visit>
void for_corners(std::span<const Cell> cells, PieceNumbers& numbers, const Visit& visit) {
  const auto count = static_cast<std::int64_t>(cells.size()), pieces = static_cast<std::int64_t>(numbers.size());
  parallel::parallel_for(0, pieces, [&](std::int64_t begin, std::int64_t end) {
    for (auto piece = begin; piece < end; ++piece) {
      auto& own = numbers[static_cast<std::size_t>(piece)];
      for (auto c = count * piece / pieces; c < count * (piece + 1) / pieces; ++c)
        for (const auto n : cells[static_cast<std::size_t>(c)])
          if (const auto node = static_cast<std::size_t>(n); n >= 0 && node < own.size())
            visit(own[node], static_cast<std::int32_t>(c));
    }
  });
}

}  // namespace

PieceNumbers count_corners(std::size_t node_count, std::span<const Cell> cells) {
  const auto pieces = std::min<std::int64_t>(parallel::thread_count(), max_pieces);
  PieceNumbers counts(static_cast<std::size_t>(pieces), std::vector<std::int32_t>(node_count, 0));
  for_corners(cells, counts, [](std::int32_t& number, std::int32_t) { ++number; });
  return counts;
}

std::int32_t lay_out(PieceNumbers& counts, std::size_t node, std::int32_t first) {
  for (auto& of_piece : counts) first += std::exchange(of_piece[node], first);
  return first;
}

void collect_stars(std::span<const Cell> cells, PieceNumbers& places, std::vector<std::int32_t>& pool) {
  for_corners(cells, places,
              [&](std::int32_t& place, std::int32_t cell) { pool[static_cast<std::size_t>(place++)] = cell; });
}

Stars stars_of(std::size_t node_count, std::span<const Cell> cells) {
  auto places = count_corners(node_count, cells);
  Stars stars;
  stars.first.assign(node_count + 1, 0);
  for (std::size_t n = 0; n < node_count; ++n) stars.first[n + 1] = lay_out(places, n, stars.first[n]);
  stars.cells.resize(static_cast<std::size_t>(stars.first.back()));
  collect_stars(cells, places, stars.cells);
  return stars;
}

}  // namespace heartgen::tetmesh
