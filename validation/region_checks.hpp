// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The user's own regions on the cells of meshes.
#pragma once
#include <map>
#include <string>

#include "model/report.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::validation {

/// Rows of group "regions", scope "MESH/REGION": `volume` (ml) of the cells' parts in it, `cells` that count for it,
/// and for regions that share no cell with another `tagged_difference` (%): the volume of those cells against it.
Report check_user_regions(const std::map<std::string, TetMesh>& meshes);

}  // namespace heartgen::validation
