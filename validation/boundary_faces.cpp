// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/boundary_faces.hpp"

#include <algorithm>
#include <array>

namespace heartgen::validation {
namespace {

// The face opposite to each node of a positive cell, outward by the right hand.
constexpr std::array<std::array<std::size_t, 3>, 4> cell_faces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// A face of the cell as seen from outside it.
Face outward(const Cell& cell, const Face& face) {
  std::size_t corner = 0;
  while (corner < 3 && std::find(face.begin(), face.end(), cell[corner]) != face.end()) ++corner;
  const auto& f = cell_faces[corner];
  return {cell[f[0]], cell[f[1]], cell[f[2]]};
}

}  // namespace

BoundaryFaces boundary_faces(const TetMesh& mesh, const std::vector<MeshFace>& faces,
                             const std::vector<std::uint8_t>& chosen, bool per_region) {
  BoundaryFaces result;
  const auto is_chosen = [&](std::int32_t cell) { return cell >= 0 && chosen[static_cast<std::size_t>(cell)] != 0; };
  const auto region = [&](std::int32_t cell) { return mesh.region[static_cast<std::size_t>(cell)]; };
  for (const auto& face : faces) {
    const bool here = is_chosen(face.cell), there = is_chosen(face.other);
    if (here && there && !(per_region && region(face.cell) != region(face.other))) continue;
    const auto add = [&](std::int32_t cell, std::int32_t other) {
      result.faces.push_back(outward(mesh.cells[static_cast<std::size_t>(cell)], face.nodes));
      result.cell.push_back(cell);
      result.other.push_back(other);
    };
    if (here) add(face.cell, face.other);
    if (there) add(face.other, face.cell);
  }
  return result;
}

}  // namespace heartgen::validation
