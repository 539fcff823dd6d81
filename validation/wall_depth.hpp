// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Wall depth on a mesh: Laplace's equation with linear finite elements.
#pragma once
#include <vector>

#include "model/labels.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::validation {

struct WallDepth {
  std::vector<std::int32_t> cells;  ///< cells of the ventricle, ascending
  std::vector<double> depth;        ///< per entry of cells, at the centroid: 0 endocardium to 1 epicardium
  std::vector<Vec3> normal;         ///< per entry of cells: unit gradient of the depth; zero where it vanishes
};

/// `ventricle` is lv_myocardium or rv_myocardium. 0 holds on the ventricle's own endocardium (also where papillary
/// muscles stand), 1 on the epicardium and, for the left ventricle, on the right one's endocardium; nothing flows
/// through the other faces. Empty where one of the two is missing.
WallDepth wall_depth(const TetMesh& mesh, Region ventricle);

}  // namespace heartgen::validation
