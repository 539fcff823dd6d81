// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Which cells a labelled face belongs to.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::exporters {

/// Cells on the sides of a face, the lower id first; -1 where there is none (the outside).
using FaceCells = std::array<std::int32_t, 2>;

/// Per face of the mesh. A face that belongs to no cell gets {-1, -1}.
std::vector<FaceCells> cells_of_faces(const TetMesh& mesh);

}  // namespace heartgen::exporters
