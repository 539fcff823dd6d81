// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Surfaces of triangles from files, and the voxels that a closed one has inside.
#pragma once
#include <string>

#include "generator/adapters/vtk_io.hpp"
#include "model/volume.hpp"

namespace heartgen::painting {

/// Whether a path is named as a file of triangles: .stl, .vtp, .vtk.
bool is_surface_name(const std::string& path);

/// Triangles in the file's own unit and frame; points at exactly the same place are one. Throws UserError for a file
/// that is damaged, holds none, or other polygons than triangles.
adapters::TriangleSurface read_surface_file(const std::string& path);

/// 1 at the voxel centres inside of a closed surface, on a grid of its own along LPS with cubic voxels of about
/// `voxel_mm` (larger where that would be more than 64 million). Inside is what a ray leaves an odd number of times.
/// Throws UserError, naming `path`, for a surface with an open edge, and one more than 2 m wide.
Mask inside_of(const adapters::TriangleSurface& surface, double voxel_mm, const std::string& path);

}  // namespace heartgen::painting
