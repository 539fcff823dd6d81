// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Parts of a mesh for export: some of its regions, or its faces without those inside.
#pragma once
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/labels.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::exporters {

/// Regions that a name stands for: one region, or "ventricles" (with the papillary muscles), "atria", "walls" (both),
/// "blood". Throws UserError naming the known ones.
std::set<std::int32_t> regions_named(std::span<const std::string> names);

/// The cells of some regions with the nodes they use, in the order they have in `mesh`, with their faces, rims and
/// fibres. A new outer face keeps the name of the interface that it was; where ventricles and atria were parted it is
/// "base". parent_node and parent_cell hold the ids in `mesh`.
TetMesh only_regions(const TetMesh& mesh, const std::set<std::int32_t>& regions);

/// The mesh with the faces of its outer boundary alone.
TetMesh without_interfaces(TetMesh mesh);

}  // namespace heartgen::exporters
