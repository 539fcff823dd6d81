// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Exact Euclidean distance on anisotropic grids.
#pragma once
#include <cstdint>
#include <vector>

#include "model/grid.hpp"

namespace heartgen::validation {

/// Per voxel, the distance (mm) between its centre and the nearest voxel centre with feature != 0; 1e18 without any.
/// Separable lower envelopes of parabolas (Felzenszwalb and Huttenlocher 2012).
std::vector<double> distance_to(const Grid& grid, const std::vector<std::uint8_t>& feature);

}  // namespace heartgen::validation
