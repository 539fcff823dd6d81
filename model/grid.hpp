// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A regular voxel grid in physical space. Frame: LPS (x to the patient's Left, y to the back (Posterior),
/// z up (Superior)), millimetres. Voxel centres lie at integer indices.
#pragma once
#include <array>
#include <cstdint>

#include "model/vec.hpp"

namespace heartgen {

using Index3 = std::array<std::int64_t, 3>;

struct Grid {
  Index3 size{0, 0, 0};      ///< voxels along i, j, k; i runs fastest in memory
  Vec3 spacing_mm{1, 1, 1};  ///< distance between voxel centres along i, j, k
  Vec3 origin_mm{0, 0, 0};   ///< LPS position of the centre of voxel (0, 0, 0)
  Mat3 direction;            ///< columns are the unit LPS directions of i, j, k

  std::int64_t voxel_count() const { return size[0] * size[1] * size[2]; }
  std::int64_t offset(std::int64_t i, std::int64_t j, std::int64_t k) const { return (k * size[1] + j) * size[0] + i; }
  bool contains(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
  }
  double voxel_volume_mm3() const { return spacing_mm.x * spacing_mm.y * spacing_mm.z; }
  friend bool operator==(const Grid&, const Grid&) = default;
};

/// LPS position (mm) of a continuous index.
inline Vec3 lps_from_index(const Grid& grid, const Vec3& index) {
  return grid.origin_mm +
         grid.direction * Vec3{index.x * grid.spacing_mm.x, index.y * grid.spacing_mm.y, index.z * grid.spacing_mm.z};
}

/// Continuous index of an LPS position (mm). The direction matrix is orthonormal.
inline Vec3 index_from_lps(const Grid& grid, const Vec3& lps_mm) {
  const Vec3 local = transposed(grid.direction) * (lps_mm - grid.origin_mm);
  return {local.x / grid.spacing_mm.x, local.y / grid.spacing_mm.y, local.z / grid.spacing_mm.z};
}

/// Whether an LPS position lies within the outermost voxel centres.
inline bool contains_point(const Grid& grid, const Vec3& lps_mm) {
  const Vec3 index = index_from_lps(grid, lps_mm);
  for (int axis = 0; axis < 3; ++axis)
    if (!(index[axis] >= 0 && index[axis] <= static_cast<double>(grid.size[static_cast<std::size_t>(axis)] - 1)))
      return false;
  return true;
}

/// LPS direction (unit length kept) of a vector given along the grid's axes in mm.
inline Vec3 lps_from_axes(const Grid& grid, const Vec3& axes_mm) { return grid.direction * axes_mm; }

}  // namespace heartgen
