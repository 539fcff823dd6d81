// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The surface of a chosen set of cells.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::validation {

struct BoundaryFaces {
  std::vector<Face> faces;          ///< node ids, normal (right hand) pointing out of the chosen cells
  std::vector<std::int32_t> cell;   ///< per face, the chosen cell it belongs to
  std::vector<std::int32_t> other;  ///< per face, the cell on the other side (not chosen), or -1 at the mesh's boundary
};

/// Faces between the cells with chosen[c] != 0 and the rest, in the order of `faces`: all of the mesh, from mesh_faces.
/// `chosen` is per cell. With `per_region`, also the faces between chosen cells of different regions, once for either
/// side.
BoundaryFaces boundary_faces(const TetMesh& mesh, const std::vector<MeshFace>& faces,
                             const std::vector<std::uint8_t>& chosen, bool per_region = false);

}  // namespace heartgen::validation
