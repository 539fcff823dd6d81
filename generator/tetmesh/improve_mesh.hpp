// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Raises the worst angles of anybody's tetrahedral mesh: the lattice mesher's repair, with the mesh's own surfaces in
/// place of level sets. Regions, the outer surface, interfaces, planes and sharp edges stay. Klingner and Shewchuk
/// 2007.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::tetmesh {

struct ImproveSettings {
  double goal_deg = 20;              ///< dihedral angles below it, and as obtuse ones, are worked on; 1 to 40
  double slide_mm = 0;               ///< how far surfaces may come off the given ones; 0: their nodes and faces stay
  double feature_deg = 30;           ///< edges where a surface turns by more keep their nodes
  std::int64_t budget = 10'000'000;  ///< attempts on bad cells at most
};

struct ImprovedMesh {
  std::vector<Vec3> nodes_mm;
  std::vector<Cell> cells;             ///< positively oriented
  std::vector<std::int32_t> region;    ///< per cell, as given
  std::vector<std::int32_t> old_node;  ///< per node: the given node that it was, -1 for a new one; ascending, then -1
  double drift_mm = 0;                 ///< greatest distance of the new surfaces from the given ones
  bool is_fixed = true;                ///< the surfaces were not changed
  std::int64_t cells_below_goal = 0;
};

/// `region` may hold any values, at most 23 different ones, or be empty. The least quality of all cells (see
/// tetmesh/quality.hpp) never falls. Where sliding would take a surface farther than `slide_mm`, the mesh is improved
/// with fixed surfaces instead. Deterministic, for any number of threads.
/// Throws UserError for settings out of range, more regions, cells that name missing nodes, a face of three cells.
ImprovedMesh improve_mesh(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                          const std::vector<std::int32_t>& region, const ImproveSettings& settings);

}  // namespace heartgen::tetmesh
