// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// DICOM files followed from element to element, before a library sees them: lengths against the file's own size.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace heartgen::adapters {

/// Whether a file begins as those of the DICOM format do.
bool is_dicom_file(const std::string& path);

/// What a file says of itself.
struct DicomFile {
  std::filesystem::path path;
  std::uintmax_t bytes = 0;
  bool is_dicom = false;  ///< begins as one; the rest is empty where it does not
  std::string sop_class;  ///< what kind of object it holds (0002,0002)
  std::int64_t rows = 0, columns = 0, frames = 1;
};

/// The files of a folder that a series may lack if a library leaves them out: all but hidden ones, a directory of media
/// (DICOMDIR), and notes in plain text. Throws UserError for one that cannot be opened, that ends within an element, or
/// that has fewer pixels than its rows and columns ask for. Compressed pixels are left to their decoder.
std::vector<DicomFile> dicom_files(const std::string& folder);

}  // namespace heartgen::adapters
