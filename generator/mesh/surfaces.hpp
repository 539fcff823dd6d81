// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Faces of a tetrahedral mesh: found from its cells, labelled by the two materials that meet there, and the rims where
/// labelled surfaces end.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "model/labelled_cells.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

/// A face with the cells on its two sides; `other` is -1 at the end of the mesh.
struct CellFace {
  Face nodes;              ///< normal out of `cell`
  std::int32_t cell = -1;  ///< the smaller id of the two
  std::int32_t other = -1;
};

/// Every face of the mesh once, sorted by its ascending node ids.
std::vector<CellFace> cell_faces(const std::vector<Cell>& cells);

/// Builds the mesh of the cells that `keep` accepts (by label), with the nodes they use, in the given order. Every face
/// of a kept cell against another label, or against no cell (label 0), gets `surface_of(label, other label)`; of two
/// kept cells the smaller label comes first and the face's normal points out of it.
TetMesh assemble(const LabelledCells& cells, const std::function<bool(std::int32_t)>& keep,
                 const std::function<std::int32_t(std::int32_t, std::int32_t)>& surface_of);

/// The nodes on edges that exactly one face of `surface` has: empty for a closed surface, and for none.
Rim rim_of(const TetMesh& mesh, std::int32_t surface);

}  // namespace heartgen::mesh
