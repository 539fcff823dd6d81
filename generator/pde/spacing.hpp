// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Lengths of a grid, over the axes that have more than one voxel.
#pragma once
#include <algorithm>

#include "model/grid.hpp"

namespace heartgen::pde {

/// 1 for a single voxel.
inline double smallest_spacing(const Grid& grid) {
  double smallest = 1e30;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (grid.size[axis] > 1) smallest = std::min(smallest, grid.spacing_mm[static_cast<int>(axis)]);
  return smallest < 1e30 ? smallest : 1;
}

/// 1 / spacing, 0 along an axis with one voxel: differences along it vanish.
inline double inverse_spacing(const Grid& grid, std::size_t axis) {
  return grid.size[axis] > 1 ? 1 / grid.spacing_mm[static_cast<int>(axis)] : 0;
}

}  // namespace heartgen::pde
