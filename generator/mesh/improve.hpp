// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Raises the worst angles of a labelled tetrahedral mesh by flips and by moving vertices, with its surfaces in place.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

struct ImproveSettings {
  double goal_deg = 18;        ///< cells with a dihedral angle below this, or above 180 minus this, are worked on
  double surface_drift = 0.1;  ///< a vertex of a surface moves in its tangent plane, and at most by this share of its
                               ///< shortest edge per round
  double curve_drift = 0.04;   ///< likewise, in any direction, where three or more labels meet
  int rounds = 3;              ///< of vertex moves per pass
  int passes = 3;              ///< of flips and vertex moves
};

/// Cells with labels 1 to first_dropped_label - 1 are improved; the others are to be dropped, and may degenerate.
/// Vertices inside one label move freely, vertices between two labels along their surface, vertices where more labels
/// meet hardly, and not at all at the border of the dropped cells; no face between two labels is changed. No step
/// lowers the worst of the cells that it touches, so nothing is inverted that was not. Cells end in canonical order
/// (ascending, smallest node first). Deterministic.
void improve(std::vector<Vec3>& nodes_mm, std::vector<Cell>& cells, std::vector<std::int32_t>& label,
             std::int32_t first_dropped_label, const ImproveSettings& settings);

/// The one way of writing cells: positive volume, smallest node first, then the smallest of the others; cells
/// ascending.
void sort_cells(const std::vector<Vec3>& nodes_mm, std::vector<Cell>& cells, std::vector<std::int32_t>& label);

}  // namespace heartgen::mesh
