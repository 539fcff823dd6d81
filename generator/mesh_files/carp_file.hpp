// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Tetrahedral meshes of openCARP: NAME.pts, NAME.elem and NAME.lon, or binary NAME.bpts, NAME.belem and NAME.blon.
#pragma once
#include <filesystem>

#include "model/unstructured_data.hpp"

namespace heartgen::mesh_files {

/// `path` is any one of the files; the .lon may be absent. Tags become the arrays "region" of tetrahedra and triangles,
/// the one or two axes of the .lon the arrays "fiber" and "sheet". Coordinates as in the file, which are µm by
/// convention. Throws UserError for files that are cut off or contradict each other.
UnstructuredData read_carp(const std::filesystem::path& path);

}  // namespace heartgen::mesh_files
