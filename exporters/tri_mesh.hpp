// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Triangle meshes of a slice as files.
#pragma once
#include <filesystem>
#include <vector>

#include "model/tri_mesh.hpp"

namespace heartgen::exporters {

/// By the path's extension. .vtu: triangles with the cell array `region`, and beside it a .vtp with the labelled edges
/// (cell array `curve`). .msh: gmsh 2.2 text with triangles, edges and their physical names. Returns the files written.
/// Throws UserError for another extension, and when a file cannot be written.
std::vector<std::filesystem::path> write_tri_mesh(const std::filesystem::path& path, const TriMesh& mesh);

}  // namespace heartgen::exporters
