// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The sides of a polygon in a curve all lie on its hollow side: areas shrink, and every side errs to one side. A small
/// shift of the nodes to the other side sets the area right and lowers the greatest distance (see
/// surface_fit/volume_correction.hpp).
#pragma once
#include "generator/distmesh/triangles.hpp"

namespace heartgen::distmesh {

/// Shifts nodes between exactly two labels, and on no side of the box, along the curve's normal by two thirds of the
/// mean error of their sides' middles: the mean distance of a parabola's chord. Kept where no triangle falls below
/// `min_deg` or, if it is below already, gets worse. To be done last: smoothing undoes it.
void balance_curves(Triangles& mesh, const Materials& materials, double min_deg);

}  // namespace heartgen::distmesh
