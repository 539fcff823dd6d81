// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Every face of a mesh once, in the order that finite-volume codes want.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::exporters {

/// Inner faces first, by owner, then by neighbour ("upper triangular"); then the outer ones by surface tag, then by
/// owner. A face's normal points out of its owner, the cell of the lower id.
struct PolyFaces {
  std::vector<Face> nodes;
  std::vector<std::int32_t> owner;
  std::vector<std::int32_t> neighbour;  ///< of the inner faces only: its length is their number
  std::vector<std::int32_t> surface;    ///< per face; 0: none
};

/// Throws UserError where three cells share a face.
PolyFaces poly_faces(const TetMesh& mesh);

}  // namespace heartgen::exporters
