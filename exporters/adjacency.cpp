// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/adjacency.hpp"

#include <algorithm>

namespace heartgen::exporters {
namespace {

struct KeyedFace {
  Face key;  ///< ascending node ids
  std::size_t index;
};

Face ascending(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

std::vector<KeyedFace> sorted_faces(const TetMesh& mesh) {
  std::vector<KeyedFace> faces;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) faces.push_back({ascending(mesh.faces[f]), f});
  std::sort(faces.begin(), faces.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  return faces;
}

}  // namespace

std::vector<FaceCells> cells_of_faces(const TetMesh& mesh) {
  constexpr std::size_t corners[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
  const auto faces = sorted_faces(mesh);
  std::vector<char> on_face(mesh.nodes_mm.size(), 0);
  for (const auto& face : mesh.faces)
    for (const auto node : face) on_face[static_cast<std::size_t>(node)] = 1;
  std::vector<FaceCells> cells(mesh.faces.size(), FaceCells{-1, -1});
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto& corner : corners) {
      const Face key = ascending({mesh.cells[c][corner[0]], mesh.cells[c][corner[1]], mesh.cells[c][corner[2]]});
      if (!std::all_of(key.begin(), key.end(), [&](auto n) { return on_face[static_cast<std::size_t>(n)] != 0; }))
        continue;
      const auto found = std::lower_bound(faces.begin(), faces.end(), key,
                                          [](const auto& face, const Face& k) { return face.key < k; });
      if (found == faces.end() || found->key != key) continue;
      auto& sides = cells[found->index];
      (sides[0] < 0 ? sides[0] : sides[1]) = static_cast<std::int32_t>(c);
    }
  return cells;
}

}  // namespace heartgen::exporters
