// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// DICOM series through ITK's GDCM. Private to the adapters: use itk_io.hpp.
#pragma once
#include <string>

#include "model/volume.hpp"

namespace heartgen::adapters {

/// The one series in a folder, whatever its files are called, with its rescale applied. Throws UserError: no series or
/// several, slices that are missing, unevenly spaced, twice at one place (several phases) or shifted against each other
/// (a tilted gantry), and a file that lies among them but cannot be read, or is cut off.
Volume<float> read_dicom_series(const std::string& folder, bool allow_2d);

}  // namespace heartgen::adapters
