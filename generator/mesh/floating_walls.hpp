// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Walls in one piece: what floats beside the heart has no support in mechanics, and no excitation ever reaches it.
#pragma once
#include <cstdint>
#include <vector>

#include "generator/mesh/label_repair.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

/// Cells of `walls` that share no node with the largest piece take the one label that they touch most of what is no
/// wall, 0 outside included. A piece of 2 % of the walls' volume or more stays: left and right heart need not touch.
/// Returns the number of cells that changed.
std::int64_t absorb_floating_walls(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                                   std::vector<std::int32_t>& label, const LabelSet& walls);

}  // namespace heartgen::mesh
