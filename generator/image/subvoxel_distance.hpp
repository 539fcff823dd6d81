// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Distances to surfaces of labels, finer than the grid that they are on. A mask says on which side of a surface a
/// voxel lies; how much of its surroundings belongs to a label says where between two voxels the surface runs. Not
/// collective; the same bits for any number of threads.
#pragma once
#include "model/volume.hpp"

namespace heartgen::image {

/// Distance in mm to the surface of `inside`, negative inside, zero where `share` (0 to 1 per voxel) is a half. Where
/// the mask is not where the share is over a half, and with an empty share, zero half-way between voxel centres.
LevelSet signed_distance(const Mask& inside, const Volume<float>& share);

}  // namespace heartgen::image
