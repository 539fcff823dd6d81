// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The image around the heart for the report's slices: 8 bit grey values and the label map on one grid.
#pragma once
#include <cstdint>
#include <string>

#include "model/volume.hpp"

namespace heartgen::report {

struct SliceData {
  std::string index_json;   ///< grid, grey values, regions, and where the arrays start
  std::string data_base64;  ///< deflated: differences of grey values along i (mod 256), then labels
  bool has_ct = false;
  bool empty = true;  ///< nothing is labelled
};

/// The box of chambers and walls (of all labels where there are none) with a margin, every n-th voxel of the label
/// map so that at most `max_voxels` are left; grey values are means over these steps where the CT is on the same grid.
/// `ct` may be null.
SliceData slice_data(const CtVolume* ct, const LabelVolume& labels, std::int64_t max_voxels = 4'000'000);

}  // namespace heartgen::report
