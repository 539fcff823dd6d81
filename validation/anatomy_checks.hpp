// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What every heart has: valves' orifices between chambers that are there, of a human size.
#pragma once
#include <map>
#include <string>

#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::validation {

/// Rows of group "anatomy", scope = the orifice. `area` (cm2) of the faces between its two regions in the mesh that
/// holds the blood ("chambers", or "torso"), 0 where they do not touch; `missing` = 1 where the label map lacks one of
/// the two, such as a great vessel. Without a mesh of the blood only `missing`.
Report check_orifices(const std::map<std::string, TetMesh>& meshes, const LabelVolume& labels);

}  // namespace heartgen::validation
