// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Tetrahedral meshes in INRIA's Medit files, as FreeFEM, mmg and TetGen have them: .mesh (text) and .meshb (binary).
#pragma once
#include <filesystem>

#include "model/unstructured_data.hpp"

namespace heartgen::mesh_files {

/// References become the arrays "region" of tetrahedra and triangles; those of vertices, where they are not all 0, the
/// array "vertex_reference". Throws UserError for another kind of file and for one that is cut off or contradicts
/// itself.
UnstructuredData read_medit(const std::filesystem::path& path);

}  // namespace heartgen::mesh_files
