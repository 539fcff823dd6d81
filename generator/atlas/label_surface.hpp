// Surfaces of label maps below the voxel. A smoothed distance has even surfaces, but where they bend sharply, in
// grooves and at corners, smoothing moves them to the wrong side of whole voxels; these say by how much. Not
// collective; the same bits for any number of threads.
#pragma once
#include "model/volume.hpp"

namespace heart::atlas {

/// Moves the zero set of `surface` (mm, negative inside) until voxel centres lie on the side that `inside` puts them
/// on, but for what single voxels ask for: the means over the voxels on the wrong side are taken `reach_voxels`
/// (standard deviation) far along and across the surface, `rounds` times.
void respect_labels(const Mask& inside, double reach_voxels, int rounds, LevelSet& surface);

}  // namespace heart::atlas
