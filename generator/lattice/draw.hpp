// Nodes where three materials meet, drawn back onto the curve that they stand for: labels that were settled, and edges
// that were cut very near to a node, leave some of them beside it.
#pragma once
#include "generator/lattice/complex.hpp"
#include "generator/lattice/materials.hpp"

namespace heart::lattice {

/// Moves nodes that touch three labels or more (the outside is one) to where these meet, or as much of the way as
/// leaves no cell below `least_quality` or, if one is below already, below the worst around. Needs derive_touches.
void draw_to_curves(Complex& complex, const Materials& materials, double least_quality);

}  // namespace heart::lattice
