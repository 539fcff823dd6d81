// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Values of nodes on a regular grid: what the 3D view colours the faces of a cut with.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::validation {

struct ValueGrid {
  Vec3 low_mm;  ///< corner of the first cube
  double spacing_mm = 2;
  std::array<std::int64_t, 3> count{};  ///< cubes; x fastest
  std::vector<std::int32_t> cube;       ///< per node
};

/// Around the nodes, with a margin of two cubes; at most 160 cubes along an axis.
ValueGrid make_value_grid(const std::vector<Vec3>& nodes_mm);

enum class Join { mean, largest };

/// Per cube the values of its nodes joined, and around these, two cubes far, of the known neighbours; NaN where
/// unknown. `values` is per node.
std::vector<double> grid_values(const ValueGrid& grid, const std::vector<double>& values, Join join);

}  // namespace heartgen::validation
