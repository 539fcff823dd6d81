// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The faces that bound a mesh and its regions, found from the cells.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh_files {

struct SurfaceFace {
  Face nodes;  ///< as `cell` shows them to the outside
  std::int32_t cell = -1;
  std::int32_t other = -1;  ///< -1: the outside
};

/// Faces of one cell alone, and of two cells of different regions (of the smaller one `cell`), in the order of their
/// ascending nodes. `region` per cell, or empty: all the same. Cells are positively oriented.
std::vector<SurfaceFace> surface_faces(const std::vector<Cell>& cells, const std::vector<std::int32_t>& region);

}  // namespace heartgen::mesh_files
