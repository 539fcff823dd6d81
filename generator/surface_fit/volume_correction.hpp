// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Nodes on a curved surface make flat faces that all lie on its hollow side: volumes shrink, and every face errs to
/// one side. A small shift of the nodes to the other side halves the greatest distance and sets the volume right.
#pragma once
#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::surface_fit {

/// Some rounds of small shifts of all nodes on surfaces and curves. Between two labels a node goes along the surface's
/// normal (in the side of the box if it lies on one) by the mean error of its faces, and nearer to its neighbours where
/// it stands out from them; on a curve it goes to the curve. None where a cell falls below `min_quality` or, if it is
/// below already, gets worse. To be done last: smoothing undoes it.
void correct_surface_volumes(tetmesh::Complex& complex, const tetmesh::Materials& materials, double min_quality);

/// Where nodes cannot go far enough, a surface as a whole still lies on one side. What it lacks is shared by all of its
/// nodes: each surface between two labels whose faces are off by more than 1/2000 of the lattice's width in the
/// mean is shifted by as much. Nodes keep their limits and cells their quality as above. The same result for any number
/// of threads.
void equalize_volumes(tetmesh::Complex& complex, const tetmesh::Materials& materials, double min_quality);

}  // namespace heartgen::surface_fit
