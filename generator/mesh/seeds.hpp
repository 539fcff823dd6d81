// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Points on every surface of a domain, for mesh generators that grow surfaces from first points.
#pragma once
#include <functional>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::mesh {

/// For every connected component (6-neighbours) of equal values in `labels`, the outermost voxels along the grid axes,
/// each moved to the surface of its component by bisection of `label_at` (LPS mm, defined beyond the grid too).
/// Points are at least `apart_mm` from each other, those of larger components first: a component much smaller than
/// that may get none, and is left out of the mesh.
std::vector<Vec3> surface_seeds(const LabelVolume& labels, const std::function<int(const Vec3&)>& label_at,
                                const std::function<double(const Vec3&)>& apart_mm);

}  // namespace heartgen::mesh
