// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The closed surfaces of blood pools around the walls of a mesh.
#pragma once
#include <map>
#include <string>

#include "model/report.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::validation {

/// Rows of group "cavities", scope "MESH/CAVITY": open_edges, non_manifold_edges, non_manifold_vertices, turned_edges
/// (that two triangles have in the same direction), caps, cap_nodes_off_rims (nodes of caps on no edge at which the
/// walls end), volume (ml, negative where the normals look inwards), and where a mesh holds the blood
/// volume_difference (%) from its cells.
Report check_cavities(const std::map<std::string, TetMesh>& meshes);

}  // namespace heartgen::validation
