// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Regions of the user's own as files hold them: label images and closed surfaces.
#pragma once
#include <string>
#include <vector>

#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::painting {

/// Where a region lies: 1 in its voxels, each the box around its centre. The grid ends where the region does.
struct RegionMask {
  std::string name;
  std::string file;       ///< it comes from, for messages
  std::size_t entry = 0;  ///< of the list of files
  Mask mask;
};

/// "FILE", "FILE:NAME" or "FILE:NAME,NAME" of the command line. What is a file as a whole has no names.
RegionSettings region_argument(const std::string& text);

/// The regions of all files, in the files' order and of one file by value. Names are those given, or of the file's
/// segments, or the file's own, with the value behind it where there are several. Throws UserError for a file that
/// cannot be read or holds nothing, a surface that is not closed, as many names as values, names that are no words of
/// letters, digits and '_', that occur twice or that heartgen uses itself, and more than 49 regions. Root only.
std::vector<RegionMask> read_regions(const std::vector<RegionSettings>& files);

/// The files with the names of their regions written out.
std::vector<RegionSettings> with_names(const std::vector<RegionSettings>& files,
                                       const std::vector<RegionMask>& regions);

}  // namespace heartgen::painting
