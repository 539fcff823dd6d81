// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// NIfTI reading through the reference library. ITK 5.2's own reader refuses many valid files that carry only an sform
/// matrix (its issues 2674 and 3333), and those are what common converters write.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::adapters {

/// The grid alone, from the header. `phase` as in read_nifti. Throws UserError for a damaged header or another number
/// of dimensions than three, or four with a phase.
Grid read_nifti_grid(const std::string& path, int phase = 0);

/// Values and names of structures that a .nii or .nii.gz file holds in an extension of its header, a LabelTable in the
/// XML of Caret, as TotalSegmentator writes it; none where there is none. Throws UserError as read_nifti_grid.
std::vector<std::pair<std::int32_t, std::string>> read_nifti_label_names(const std::string& path);

/// Reads a 3D scalar NIfTI-1 file, or volume `phase` (from 1; 0: there is but one) of a 4D one
/// (.nii, .nii.gz), with its intensity scaling applied; the frame is turned from the
/// format's RAS to LPS. Throws UserError: damaged header, truncated data, sheared or missing orientation.
Volume<float> read_nifti(const std::string& path, int phase = 0);

}  // namespace heartgen::adapters
