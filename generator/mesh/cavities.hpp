// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The pools of blood as closed surfaces of the walls around them, for who simulates walls and needs the volume inside.
#pragma once
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

/// Of the four chambers, those that the mesh holds with their walls: the faces of muscle around the blood, and for
/// each hole that they leave a cap between its nodes alone (fill_loop). A hole is called after the surface that the
/// blood has there over the largest area: "mitral_orifice_cap". `mesh` holds blood and walls; its faces are labelled.
std::vector<Cavity> find_cavities(const TetMesh& mesh);

/// Cavities of a mesh on a part of it; `new_node` holds -1 for nodes that are no part. Those that miss a node go.
std::vector<Cavity> cavities_of_part(const std::vector<Cavity>& cavities, const std::vector<std::int32_t>& new_node);

}  // namespace heartgen::mesh
