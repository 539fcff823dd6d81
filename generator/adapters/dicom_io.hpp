// DICOM series through ITK's GDCM. Private to the adapters: use itk_io.hpp.
#pragma once
#include <string>

#include "model/volume.hpp"

namespace heart::adapters {

/// Whether a file begins as those of the DICOM format do.
bool is_dicom_file(const std::string& path);

/// The one series in a folder, whatever its files are called, with its rescale applied. Throws UserError: no series or
/// several, slices that are missing, unevenly spaced, twice at one place (several phases) or shifted against each other
/// (a tilted gantry).
Volume<float> read_dicom_series(const std::string& folder);

}  // namespace heart::adapters
