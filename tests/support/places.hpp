// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Places to test at.
#pragma once
#include <cstdint>
#include <vector>

#include "model/grid.hpp"

namespace heartgen::testing {

/// first, first + step and so on, all below `end`.
inline std::vector<double> steps(double first, double end, double step) {
  std::vector<double> values;
  while (first + step * static_cast<double>(values.size()) < end)
    values.push_back(first + step * static_cast<double>(values.size()));
  return values;
}

/// LPS position (mm) of the centre of a voxel, by its place in memory.
inline Vec3 lps_of_voxel(const Grid& grid, std::int64_t voxel) {
  const std::int64_t j = voxel / grid.size[0] % grid.size[1], k = voxel / (grid.size[0] * grid.size[1]);
  return lps_from_index(grid,
                        {static_cast<double>(voxel % grid.size[0]), static_cast<double>(j), static_cast<double>(k)});
}

}  // namespace heartgen::testing
