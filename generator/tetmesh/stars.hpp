// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The cells around every node, collected by several threads.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::tetmesh {

/// The cells of each node, ascending.
struct Stars {
  std::vector<std::int32_t> first;  ///< per node, and one more: where its cells begin
  std::vector<std::int32_t> cells;
  std::span<const std::int32_t> of(std::int32_t node) const {
    const auto n = static_cast<std::size_t>(node);
    return {cells.data() + first[n], static_cast<std::size_t>(first[n + 1] - first[n])};
  }
};

/// Corners that are not in [0, node_count) are passed over.
Stars stars_of(std::size_t node_count, std::span<const Cell> cells);

/// A number for each node in each of a few pieces of a list of cells, which threads work on at the same time.
using PieceNumbers = std::vector<std::vector<std::int32_t>>;

/// How often each node occurs in each piece of the cells.
PieceNumbers count_corners(std::size_t node_count, std::span<const Cell> cells);

/// Turns a node's counts into the places of a pool where each piece's cells of that node begin, the first at `first`;
/// returns the place after the last one.
std::int32_t lay_out(PieceNumbers& counts, std::size_t node, std::int32_t first);

/// Puts the number of each cell at the next place of each of its nodes: those of one node come in the order of the
/// cells. Afterwards the places are used up.
void collect_stars(std::span<const Cell> cells, PieceNumbers& places, std::vector<std::int32_t>& pool);

}  // namespace heartgen::tetmesh
