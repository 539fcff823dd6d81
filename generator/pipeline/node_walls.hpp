// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Which ventricle's wall a node of a mesh belongs to, for `heartgen-lab fiber-accuracy`.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::pipeline {

/// Per node, a tag of labels.hpp: the right ventricle's where one of the node's cells is its muscle, else that of the
/// node's last cell; 0 without cells.
std::vector<std::int32_t> regions_of_nodes(const TetMesh& mesh);

/// The same, but 0 where the node's cells are of different regions.
std::vector<std::int32_t> regions_of_own_nodes(const TetMesh& mesh);

}  // namespace heartgen::pipeline
