// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <set>
#include <vector>

#include "generator/mesh/surfaces.hpp"
#include "model/labelled_cells.hpp"
#include "support/diced_cubes.hpp"

namespace heartgen::testing {

// n × n × n cubes of six cells each, with label 1 below `split` layers and 2 above, and a rim of label 0 around.
inline LabelledCells cube(int n, int split) {
  LabelledCells mesh;
  mesh.nodes_mm = cube_corners(n);
  const auto outside = [n](int i) { return i == 0 || i == n - 1; };
  dice_cubes(n, [&](const Cell& cell, int i, int j, int k) {
    mesh.cells.push_back(cell);
    mesh.label.push_back(outside(i) || outside(j) || outside(k) ? 0 : k < split ? 1 : 2);
  });
  return mesh;
}

inline double volume_of(const LabelledCells& mesh, std::int32_t label) {
  TetMesh whole;
  whole.nodes_mm = mesh.nodes_mm;
  double volume = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.label[c] == label) volume += cell_volume_mm3(whole, mesh.cells[c]);
  return volume;
}

inline std::set<std::set<std::int32_t>> interface_faces(const LabelledCells& mesh) {
  std::set<std::set<std::int32_t>> faces;
  for (const auto& f : mesh::cell_faces(mesh.cells))
    if (f.other >= 0 && mesh.label[static_cast<std::size_t>(f.cell)] != mesh.label[static_cast<std::size_t>(f.other)])
      faces.insert({f.nodes[0], f.nodes[1], f.nodes[2]});
  return faces;
}

}  // namespace heartgen::testing
