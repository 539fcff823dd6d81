// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What ITK's reader and writer of MetaImages (.mhd, .mha) leave unsaid.
#pragma once
#include <cstdint>
#include <string>

namespace heartgen::adapters {

/// Before the library, which copies names and texts of a header into fixed places and looks at no bound. Throws
/// UserError for a line that does not fit there, for a number of dimensions that no image has, and for sizes that are
/// no numbers.
void check_meta_header(const std::string& path);

bool is_meta_image(const std::string& path);

/// Throws UserError where the file is truncated or its spacing is negative; ITK reads both without an error, and does
/// not notice a full disk when it writes. `voxel_bytes`: of the voxels when not compressed. Voxels in a list of files
/// or in a file of a named pattern are left to ITK.
void check_meta_image(const std::string& path, std::uintmax_t voxel_bytes, const char* remedy);

/// Sets the name of the file, beside the header, that holds its voxels. False when it cannot be written.
bool point_to_voxels(const std::string& header, const std::string& voxels_file);

}  // namespace heartgen::adapters
