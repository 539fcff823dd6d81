// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A label map between its voxels, as the certificate reads it: by its own interpolation, whatever a mesher makes of
/// it.
#pragma once
#include "model/volume.hpp"

namespace heartgen::validation {

/// The label with the largest share at a place: linear interpolation of each label's indicator between the eight voxels
/// around it, the smaller label where two are equal. 0 beyond half a voxel from the outermost voxels.
int label_between_voxels(const LabelVolume& labels, const Vec3& lps_mm);

}  // namespace heartgen::validation
