// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Exact Euclidean distances on a voxel grid, by one lower envelope of parabolas per line and axis
/// (Felzenszwalb and Huttenlocher 2012, Maurer et al. 2003). Any spacing; lines are shared between threads, and the
/// result does not depend on how many there are.
#pragma once
#include "model/volume.hpp"

namespace heartgen::image {

/// Distance (mm) of every voxel centre to the nearest centre of a set voxel: 0 on the mask. Where the mask is empty
/// every distance is `far_mm`; no distance exceeds it.
Volume<float> distance_to(const Mask& mask, float far_mm = 1e6F);

/// Signed distance (mm) to the mask's surface, negative inside. The surface lies half-way between the centres of
/// neighbouring set and unset voxels, so that the zero set is within half a voxel of the true one.
LevelSet signed_distance(const Mask& mask);

/// For every voxel the tag of the nearest labelled voxel, at most `limit_mm` away (else 0). Labelled voxels keep
/// their own tag.
LabelVolume nearest_label(const LabelVolume& labels, double limit_mm);

struct NearestLabel {
  LabelVolume label;          ///< tag of the nearest labelled voxel; 0 where none is labelled
  Volume<float> distance_mm;  ///< to it, 1e6 where none is labelled
};

/// The nearest label at any distance, and that distance.
NearestLabel nearest_label_and_distance(const LabelVolume& labels);

}  // namespace heartgen::image
