// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Axes of cells across which fibres turn far: in a wall of one or two cells the nodes lie on its two surfaces, 120
/// degrees apart, and a mean of their axes is that of neither and of nothing between. Not collective.
#pragma once
#include <string>

#include "generator/fibers/registered_pair.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::fibers {

/// Sets the frame of each ventricular cell two of whose nodes' fibres are more than 25 degrees apart to what is carried
/// to the cell's centroid: out of the fits at its nodes, `carried`, where all four are of its wall and none more than
/// 60 degrees off another, else by a fit of its own. Other cells, and those that nothing can be carried to, keep
/// theirs. `node`, `cell`, `carried`: of the whole mesh. The same bits for any number of threads.
void carry_to_steep_cells(const RegisteredPair& hearts, const TetMesh& mesh, const FiberField& node,
                          const FittedAxes& carried, const std::string& method, FiberField& cell);

}  // namespace heartgen::fibers
