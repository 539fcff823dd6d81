// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Raises the worst angles of a tetrahedral mesh by exchanging cells: bad cells lose an edge (the cells around it are
/// replaced by the best others that fill the same space) or a face (two cells become three). Freitag and
/// Ollivier-Gooch 1997; Shewchuk 2002. Interfaces between labels stay as they are.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

/// Works on cells with labels 1 to first_dropped_label - 1 whose smallest sine of a dihedral angle is below `goal`.
/// An exchange is made only if it raises the worst cell concerned. New cells come at the end, in a fixed order.
/// Returns the number of exchanges.
std::int64_t flip_bad_cells(const std::vector<Vec3>& nodes_mm, std::vector<Cell>& cells,
                            std::vector<std::int32_t>& label, std::int32_t first_dropped_label, double goal);

}  // namespace heartgen::mesh
