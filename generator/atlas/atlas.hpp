// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How a fibre atlas is made and read.
#pragma once
#include <string>
#include <vector>

#include "model/fiber_atlas.hpp"

namespace heartgen::atlas {

/// Atlas from tetrahedra with one vector per point, or per cell (`vectors` as long as `cells`): then each point gets
/// what the cells around it lead to (point_axes.hpp). The unit is worked out from the size of the heart. Inverted cells
/// are turned round.
/// Throws UserError: no cells, indices out of range, NaN, vectors all zero, a size that is no heart's in any unit.
FiberAtlas make_fiber_atlas(std::string name, std::vector<Vec3> points, std::vector<Cell> cells,
                            const std::vector<Vec3>& vectors);

/// Reads .exnode and .exelem files (exnode.hpp), images (voxel_atlas.hpp), or a .vtk (legacy), .vtu or .msh file with
/// tetrahedra and at least one array of vectors or of tensors, whose leading axes are the fibres. `array` names it, on
/// points or on cells; empty: the one with a known name of fibres (axis_name), points before cells and vectors before
/// tensors; without a known name the only one, unless it is called normals or sheets. Throws UserError, naming file and
/// remedy; where it cannot choose it lists the arrays.
FiberAtlas read_fiber_atlas(const std::string& path, const std::string& array = {});

}  // namespace heartgen::atlas
