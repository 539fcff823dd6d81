// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The voxels of a grid whose centres lie in a tetrahedron, with their barycentric weights: meshes onto images.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "model/grid.hpp"
#include "model/vec.hpp"

namespace heartgen::mesh_queries {

/// Calls visit(offset, weights) for every voxel centre of `grid` in the tetrahedron `corners_mm` (LPS), its faces
/// included, i fastest; the four weights belong to the corners and add up to 1. None for a flat tetrahedron.
template <class Visit>
void for_voxels_in_cell(const Grid& grid, const std::array<Vec3, 4>& corners_mm, Visit&& visit) {
  constexpr double tolerance = 1e-9;
  std::array<Vec3, 4> p;  // continuous indices: weights are the same in any affine frame
  for (std::size_t n = 0; n < 4; ++n) p[n] = index_from_lps(grid, corners_mm[n]);
  const Vec3 a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
  const double det = dot(a, cross(b, c));
  if (det == 0) return;
  std::array<std::int64_t, 3> first{}, last{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({p[0][axis], p[1][axis], p[2][axis], p[3][axis]});
    const auto at = static_cast<std::size_t>(axis);
    first[at] = std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(low - tolerance)));
    last[at] = std::min(grid.size[at] - 1, static_cast<std::int64_t>(std::floor(high + tolerance)));
  }
  for (std::int64_t k = first[2]; k <= last[2]; ++k)
    for (std::int64_t j = first[1]; j <= last[1]; ++j)
      for (std::int64_t i = first[0]; i <= last[0]; ++i) {
        const Vec3 d = Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} - p[0];
        const double u = dot(d, cross(b, c)) / det, v = dot(a, cross(d, c)) / det, w = dot(a, cross(b, d)) / det;
        const double t = 1 - u - v - w;
        if (std::min({t, u, v, w}) >= -tolerance) visit(grid.offset(i, j, k), std::array<double, 4>{t, u, v, w});
      }
}

}  // namespace heartgen::mesh_queries
