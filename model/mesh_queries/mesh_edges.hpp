// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Edges of tetrahedra.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh_queries {

using NodePair = std::array<std::int32_t, 2>;  ///< ascending

/// The edges of the cells with use[c] != 0 (of all where `use` is empty), smaller node first, ascending, each once.
/// Nodes are numbered from 0 to node_count - 1.
std::vector<NodePair> edges_of_cells(const std::vector<Cell>& cells, std::size_t node_count,
                                     const std::vector<std::uint8_t>& use = {});

}  // namespace heartgen::mesh_queries
