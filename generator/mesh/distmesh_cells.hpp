// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The DistMesh back end for label maps: nodes of the stuffed lattice, relaxed as a truss that is triangulated anew as
/// it moves, settled and repaired.
#pragma once
#include "generator/mesh/lattice_cells.hpp"

namespace heartgen::mesh {

/// Cells with labels 1 to 17, nodes in LPS mm; the sides of the image are flat. `manifold_sets` as in repair_labels.
LabelledCells distmesh_cells(const MeshDomain& domain, const Volume<float>& sizes_mm,
                             std::span<const LabelSet> manifold_sets, std::int64_t crumb_cells,
                             LatticeReport* report = nullptr);

}  // namespace heartgen::mesh
