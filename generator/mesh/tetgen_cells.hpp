// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The TetGen back end: the surfaces of the lattice mesher's mesh, filled anew by constrained Delaunay refinement.
#pragma once
#include "generator/adapters/tetgen_mesher.hpp"
#include "generator/mesh/lattice_cells.hpp"
#include "generator/tetmesh/complex.hpp"

namespace heartgen::mesh {

/// The faces between two labels, or at the outside, and a seed in each piece of a label: the centre of its largest
/// cell. `old_node` gets the complex's id of each node.
adapters::SurfaceComplex surfaces_of(const tetmesh::Complex& complex, std::vector<std::int32_t>& old_node);

/// As lattice_cells; the time of TetGen is the step "tetgen". Throws UserError where TetGen fails or is missing.
LabelledCells tetgen_cells(const MeshDomain& domain, const Volume<float>& sizes_mm,
                           std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells,
                           LatticeReport* report = nullptr);

}  // namespace heartgen::mesh
