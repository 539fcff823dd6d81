// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What no heart has: islands far from it, and crumbs too small for a cell of the mesh.
#pragma once
#include <vector>

#include "model/certificate.hpp"
#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::labels {

/// Takes away pieces of walls, blood and papillary muscles that hang together with no region's largest piece; pieces of
/// the great vessels stay from 1 ml on, since the descending aorta may lie apart. Each region that lost some gets a
/// warning labels.islands with their number of voxels, volume and distance from the heart.
std::vector<Warning> drop_islands(LabelVolume& labels);

/// Gives pieces of the heart's regions of less than `crumb_mm3` (but no region's only piece, save papillary muscle) to
/// what they touch most. Returns the volume of what has changed, mm3.
double absorb_crumbs(LabelVolume& labels, double crumb_mm3);

/// The volume of a piece that the mesher gives to its neighbour at such edges.
double crumb_mm3(double edge_mm);

}  // namespace heartgen::labels
