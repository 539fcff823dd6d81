// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Sizes that a VTK file claims, against the size that it has.
#pragma once
#include <filesystem>

namespace heartgen::adapters {

/// Refuses counts that the file cannot hold, before VTK allocates memory for them: points, cells and tuples of the
/// header (XML and legacy), the nodes of the cells against the numbers behind CELLS (legacy), and the block tables of
/// appended raw data. A compressed file may hold up to the 1032-fold
/// of its size (the limit of deflate). Throws UserError; what is no VTK file is left to the reader.
void refuse_absurd_counts(const std::filesystem::path& path);

}  // namespace heartgen::adapters
