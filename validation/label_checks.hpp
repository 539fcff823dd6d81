// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What a label map alone tells: volumes, components and wall thickness of the regions.
#pragma once
#include <vector>

#include "model/labels.hpp"
#include "model/report.hpp"
#include "model/volume.hpp"

namespace heartgen::validation {

/// Rows of group "labels". Per region present: volume (ml), components (26-neighbours), largest_component (share).
/// For lv_myocardium and rv_myocardium: wall_thickness_median, _p05, _p95 (mm), over the voxels midway between the
/// cavity and the outside, as the sum of their distances to both less three quarters of a voxel. Regions in `needed`
/// get a row `volume` that judges (more than 0 ml), present or not.
Report check_labels(const LabelVolume& labels, const std::vector<Region>& needed);

}  // namespace heartgen::validation
