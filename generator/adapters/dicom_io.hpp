// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// DICOM series through ITK's GDCM. Private to the adapters: use itk_io.hpp.
#pragma once
#include <string>

#include "model/volume.hpp"

namespace heartgen::adapters {

/// The one series in a folder, whatever its files are called, with its rescale applied. Throws UserError: no series or
/// several, slices that are missing, unevenly spaced or shifted against each other (a tilted gantry), and a file that
/// lies among them but cannot be read, or is cut off. `phase`, from 1, chooses among the phases of a series, in the
/// order of trigger time, temporal position, acquisition or content time, or instance number, the first of these that
/// tells them apart; 0: there is but one.
Volume<float> read_dicom_series(const std::string& folder, bool allow_2d, int phase = 0);

}  // namespace heartgen::adapters
