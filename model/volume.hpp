// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A scalar image on a Grid: voxels in one vector, i fastest.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "model/grid.hpp"

namespace heartgen {

template <class T>
struct Volume {
  Grid grid;
  std::vector<T> voxels;  ///< grid.voxel_count() values, i fastest, then j, then k

  Volume() = default;
  explicit Volume(const Grid& grid_, T value = T{})
      : grid(grid_), voxels(static_cast<std::size_t>(grid_.voxel_count()), value) {}

  T& operator()(std::int64_t i, std::int64_t j, std::int64_t k) {
    return voxels[static_cast<std::size_t>(grid.offset(i, j, k))];
  }
  const T& operator()(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return voxels[static_cast<std::size_t>(grid.offset(i, j, k))];
  }
};

using CtVolume = Volume<std::int16_t>;     ///< Hounsfield units
using LabelVolume = Volume<std::uint8_t>;  ///< region tags of labels.hpp, 0 outside everything
using Mask = Volume<std::uint8_t>;         ///< 0 or 1
using LevelSet = Volume<float>;            ///< signed distance in mm, negative inside

/// Trilinear value at a continuous index; outside the grid the border value is continued.
template <class T>
double sample_linear(const Volume<T>& volume, const Vec3& index) {
  double result = 0;
  std::int64_t base[3];
  double fraction[3];
  for (int axis = 0; axis < 3; ++axis) {
    const auto last = volume.grid.size[static_cast<std::size_t>(axis)] - 1;
    const double clamped = std::clamp(index[axis], 0.0, static_cast<double>(last));
    base[axis] = std::min<std::int64_t>(static_cast<std::int64_t>(clamped), std::max<std::int64_t>(last - 1, 0));
    fraction[axis] = clamped - static_cast<double>(base[axis]);
  }
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::int64_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (corner >> axis) & 1;
      weight *= upper ? fraction[axis] : 1 - fraction[axis];
      at[axis] = std::min(base[axis] + upper, volume.grid.size[static_cast<std::size_t>(axis)] - 1);
    }
    if (weight != 0) result += weight * static_cast<double>(volume(at[0], at[1], at[2]));
  }
  return result;
}

}  // namespace heartgen
