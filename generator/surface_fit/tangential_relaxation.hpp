// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Faces that cut across a crease or a narrow bend of their surface: all three nodes lie on it and the middle does not.
/// Where the nodes along it lie decides how much; a better place for them is looked for in the surface.
#pragma once
#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::surface_fit {

/// Moves single nodes between two labels at faces whose centre is far from its surface, along the surface mostly, to
/// where the faces around them are nearer. None where a cell falls below `min_quality` or, if it is below already,
/// gets worse. Only surfaces of `labels`, and none to the outside: where that is narrow, two sheets could pass through
/// each other, and no cell would tell. The same result for any number of threads.
void relax_tangentially(tetmesh::Complex& complex, const tetmesh::Materials& materials, double min_quality,
                        tetmesh::LabelBits labels);

}  // namespace heartgen::surface_fit
