// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Tetrahedra with a label each, as meshers give them.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen {

/// The Delaunay cells of all vertices: they fill the convex hull, with label 0 outside the domain.
struct LabelledCells {
  std::vector<Vec3> nodes_mm;       ///< ascending z, then y, then x
  std::vector<Cell> cells;          ///< positively oriented, smallest node first, ascending
  std::vector<std::int32_t> label;  ///< per cell, as `label_at` gives it inside
  /// Per node: 0 where no face at it lies between two labels or has one cell only. Empty where that is not known.
  std::vector<std::uint8_t> is_on_surface{};
};

}  // namespace heartgen
