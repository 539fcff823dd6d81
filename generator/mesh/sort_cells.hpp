// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The one order of a mesh's cells.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

/// The one way of writing cells: positive volume, smallest node first, then the smallest of the others; cells
/// ascending.
void sort_cells(const std::vector<Vec3>& nodes_mm, std::vector<Cell>& cells, std::vector<std::int32_t>& label);

}  // namespace heartgen::mesh
