// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Raises the worst angles of a labelled mesh, with its surfaces in place.
#pragma once
#include <cstdint>

#include "model/labelled_cells.hpp"

namespace heartgen::mesh {

/// Cells with labels 1 to first_dropped_label - 1 are improved (tetmesh::improve_mesh); the others are to be dropped
/// and stay. No face between two labels is changed, no node of one is moved. Nodes in use keep their order, new ones
/// follow; cells end in canonical order. Deterministic.
void improve_kept(LabelledCells& mesh, std::int32_t first_dropped_label);

}  // namespace heartgen::mesh
