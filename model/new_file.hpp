// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A file that gets its name when it is whole.
#pragma once
#include <filesystem>

namespace heartgen {

/// Written as `partial`, hidden beside `path`, and put in its place by `finish`: neither a full disk nor a kill leaves
/// half a file, or takes away the one that was there. One program at a time writes a file: the others are refused. What
/// is no plain file (a device, a pipe), or lies in a folder where nothing can be made, is written where it is.
struct NewFile {
  std::filesystem::path path;
  std::filesystem::path place;    ///< where the file lies, behind links
  std::filesystem::path partial;  ///< ends as `path` does: libraries choose the format by it
  int lock = -1;                  ///< descriptor by which this program holds `partial`; -1: it needs none

  /// Makes the folder. Throws UserError when it cannot, or when another program is writing this file.
  explicit NewFile(const std::filesystem::path& path_);
  ~NewFile();  ///< takes away what was not finished
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Throws UserError when the file cannot take its place.
  void finish();
};

}  // namespace heartgen
