// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Tetrahedral meshes in gmsh's .msh files: versions 2.2 and 4.1, text or binary, whole or in partitions.
#pragma once
#include <filesystem>
#include <string>

#include "model/unstructured_data.hpp"

namespace heartgen::mesh_files {

/// The arrays "region" of tetrahedra and triangles are their physical groups; an entity without a group gets a number
/// that no group has. Views ($NodeData, $ElementData) become arrays, physical names `names`; what was left out or
/// chosen stands in `remarks`. Throws UserError for another kind of file, other versions, inconsistent contents,
/// volumes that are no linear tetrahedra, and without tetrahedra.
UnstructuredData read_msh(const std::filesystem::path& path);

/// Version 2.2, text. `labels` names the scalar array of tetrahedra and triangles that becomes their physical groups
/// (empty, or absent: all 1); the other arrays become views.
void write_msh(const std::filesystem::path& path, const UnstructuredData& mesh, const std::string& labels);

}  // namespace heartgen::mesh_files
