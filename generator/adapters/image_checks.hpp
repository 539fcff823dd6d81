// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What no image has, whatever its format: the one place that refuses it.
#pragma once
#include <string>

#include "model/grid.hpp"

namespace heartgen::adapters {

/// Before any voxel is read. Throws UserError for sizes, spacings, origins and directions that cannot be: no voxels,
/// more than 2048 x 2048 x 2048 of them, numbers that are not finite, lengths below 1e-6 or above 1e5 mm, axes that are
/// not at right angles.
void check_grid(const Grid& grid, const std::string& path);

/// Throws UserError, with both figures, where a model of so many voxels needs more memory than there is; and for a
/// single slice unless `allow_2d`.
void check_size(const Index3& size, const std::string& path, bool allow_2d);

/// `phase`: the one that the user wants, from 1; 0 where none is named. Throws UserError where several are there and
/// none is named, and where that one is not there.
void check_phase(int phase, int phases, const std::string& path);

/// Throws UserError where a file claims more bytes than it can hold, compressed (by deflate, at most 1032-fold) or not.
void check_claim(double claimed_bytes, double file_bytes, bool is_compressed, const std::string& path);

}  // namespace heartgen::adapters
