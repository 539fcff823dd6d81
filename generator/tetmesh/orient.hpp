// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The order of the nodes of cells from elsewhere: a cell may be written the other way round, or lie inverted in space.
#pragma once
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::tetmesh {

/// Returns the cells with their nodes in one order: neighbours across a face see it turned the other way, and in every
/// piece that hangs together through faces the volumes add up to more than 0. What is negative then lies inverted in
/// space. Cells that name missing nodes are refused elsewhere.
std::vector<Cell> oriented_cells(const std::vector<Vec3>& nodes_mm, std::vector<Cell> cells);

}  // namespace heartgen::tetmesh
