// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The eight voxels around a position and their weights in trilinear interpolation, for values that are not simply
/// added up (`sample_linear` of volume.hpp does that): labels, axes, voxels of which only some count.
#pragma once
#include <cmath>
#include <cstdint>

#include "model/vec.hpp"

namespace heartgen::mesh_queries {

/// Calls body(weight, i, j, k) for each of them, i fastest. `index` is continuous; voxels may lie outside the grid.
template <class Body>
void for_corners(const Vec3& index, Body&& body) {
  const Vec3 low{std::floor(index.x), std::floor(index.y), std::floor(index.z)};
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::int64_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (corner >> axis) & 1;
      const double fraction = index[axis] - low[axis];
      weight *= upper ? fraction : 1 - fraction;
      at[axis] = static_cast<std::int64_t>(low[axis]) + upper;
    }
    body(weight, at[0], at[1], at[2]);
  }
}

}  // namespace heartgen::mesh_queries
