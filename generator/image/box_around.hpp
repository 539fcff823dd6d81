// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the part of a grid around a point.
#pragma once
#include <algorithm>
#include <cmath>

#include "model/crop.hpp"
#include "model/grid.hpp"

namespace heartgen::image {

/// The box of voxels that a ball touches, cut to the grid; empty where it misses the grid.
inline Box box_around(const Grid& grid, const Vec3& center_mm, double radius_mm) {
  const Vec3 center = index_from_lps(grid, center_mm);
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double reach = radius_mm / grid.spacing_mm[axis];
    const auto low = static_cast<std::int64_t>(std::floor(center[axis] - reach));
    const auto high = static_cast<std::int64_t>(std::ceil(center[axis] + reach)) + 1;
    box.begin[a] = std::clamp<std::int64_t>(low, 0, grid.size[a]);
    box.end[a] = std::clamp<std::int64_t>(high, 0, grid.size[a]);
  }
  return box;
}

/// `part` at its place in a volume on `grid`, zeros around it.
template <class T>
Volume<T> pasted(const Grid& grid, const Volume<T>& part, const Box& box) {
  Volume<T> whole(grid);
  paste(part, box, whole);
  return whole;
}

}  // namespace heartgen::image
