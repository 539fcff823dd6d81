// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/tetrahedra.hpp"

#include "generator/distmesh/connect.hpp"
#include "generator/stuffing/octree.hpp"

namespace heartgen::distmesh {

tetmesh::Complex complex_of(const Truss& truss, const Materials& materials) {
  tetmesh::Complex complex;
  complex.nodes_mm = truss.nodes.at_mm;
  for (std::size_t n = 0; n < truss.nodes.size(); ++n) {
    complex.touches.push_back(truss.nodes.touches[n] & tetmesh::side_bits);
    complex.spacing_mm.push_back(
        static_cast<float>(materials.edge_mm(truss.nodes.at_mm[n]) / stuffing::mean_edge_per_cell));
  }
  // Beyond the hull of all nodes there is no simplex that could tell of the outside.
  for (const auto& face : hull_faces(truss.simplices)) {
    LabelBits shared = tetmesh::side_bits;
    for (const auto n : face) shared &= complex.touches[static_cast<std::size_t>(n)];
    for (const auto n : face)
      if (shared == 0) complex.touches[static_cast<std::size_t>(n)] |= tetmesh::hull_bit;
  }
  complex.cells = truss.simplices.cells;
  complex.label = truss.label;
  return complex;
}

}  // namespace heartgen::distmesh
