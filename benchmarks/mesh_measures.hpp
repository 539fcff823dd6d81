// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the mesh benchmarks measure on a mesh.
#pragma once
#include <array>
#include <vector>

#include "model/tet_mesh.hpp"
#include "model/vec.hpp"

namespace heartgen::benchmarks {

struct Angles {
  double least = 180, greatest = 0;  ///< dihedral, degrees
  double min_volume_mm3 = 1e300;
};

void add_cell(Angles& angles, const std::array<Vec3, 4>& corners_mm);

/// Of the cells that `is_counted(cell)` accepts.
Angles angles_of(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells, const auto& is_counted) {
  Angles angles;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!is_counted(c)) continue;
    std::array<Vec3, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = nodes_mm[static_cast<std::size_t>(cells[c][i])];
    add_cell(angles, p);
  }
  return angles;
}

/// 99th percentile and greatest of some distances; zeros where there are none.
struct Distances {
  double p99 = 0, greatest = 0;
};
Distances summary_of(std::vector<double> distances);

}  // namespace heartgen::benchmarks
