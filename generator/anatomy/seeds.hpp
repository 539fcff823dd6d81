// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Seeds as voxels, with errors that tell the user which seed is wrong and why.
#pragma once
#include <string>

#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// The voxel that holds a position. Throws UserError naming the seed where it lies outside the image.
Index3 seed_voxel(const Grid& grid, const std::string& name, const Vec3& position_mm);

/// The voxel of `mask` nearest to the seed, at most `tolerance_mm` away: a seed on a papillary muscle still means the
/// cavity. Throws UserError with the grey value at the seed where there is none; `what` says what the mask is.
Index3 seed_in_mask(const CtVolume& ct, const Mask& mask, const std::string& name, const Vec3& position_mm,
                    double tolerance_mm, const std::string& what);

/// Median of the grey values above `least` (of all by default) within a ball around the seed; `least` where there is
/// none.
double median_around(const CtVolume& ct, const Vec3& position_mm, double radius_mm, double least = -32768);

}  // namespace heartgen::anatomy
