// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Nodes where three materials meet, drawn back onto the curve that they stand for: labels that were settled, and edges
/// that were cut very near to a node, leave some of them beside it.
#pragma once
#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::surface_fit {

/// Moves nodes that touch three labels or more (the outside is one) to where these meet, or as much of the way as
/// leaves no cell below `min_quality` or, if one is below already, below the worst around. Every node must touch the
/// labels of its cells; a label that a repair has left behind counts, too.
void project_to_curves(tetmesh::Complex& complex, const tetmesh::Materials& materials, double min_quality);

}  // namespace heartgen::surface_fit
