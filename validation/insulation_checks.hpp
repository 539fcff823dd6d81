// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Whether a wave can go from the atria into the ventricles.
#pragma once
#include <map>
#include <string>

#include "model/report.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::validation {

/// Rows of group "insulation", scope = the mesh, for meshes with muscle of atria and of ventricles: the faces and nodes
/// that conducting cells of both have, `conducting_faces` and `conducting_nodes`, or where none is wanted
/// (`is_insulated` false) `shared_faces` and `shared_nodes`; and `annulus_cells`.
Report check_insulation(const std::map<std::string, TetMesh>& meshes, bool is_insulated);

}  // namespace heartgen::validation
