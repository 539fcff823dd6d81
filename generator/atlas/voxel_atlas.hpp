// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibre atlases that are images: a vector or a diffusion tensor per voxel, and the muscle as a mask.
#pragma once
#include <string>

#include "generator/atlas/atlas.hpp"
#include "model/volume.hpp"

namespace heartgen::atlas {

/// Whether `path` names a folder, or a file of an image format.
bool is_image_path(const std::string& path);

/// Reads one image with 3 (vector), 6 (xx xy xz yy yz zz), 7 (the same after a mask) or 9 (rows) components per voxel;
/// or a folder with one such image, or with three of one component named fiber_x, fiber_y, fiber_z, and optionally one
/// of whole numbers with "mask" in its name. The muscle is the mask, or where the axes are not zero; of a tensor the
/// leading axis counts. Components are along LPS axes, or along the measurement frame of a NRRD.
/// Throws UserError, naming file and remedy.
FiberAtlas read_voxel_atlas(const std::string& path);

/// Every voxel of `muscle` as a cube of six tetrahedra with its axis (zero: not known); voxels much smaller than a
/// millimetre are taken together in blocks. `axis` on the grid of `muscle`. Throws UserError as make_fiber_atlas.
FiberAtlas atlas_of_voxels(std::string name, const Mask& muscle, const Volume<Vec3>& axis);

}  // namespace heartgen::atlas
