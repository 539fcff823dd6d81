// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Delaunay triangulations of points, CGAL hidden behind plain data. Exact predicates; where more points than needed
/// lie on a circle or sphere, the symbolic perturbation decides: the same points give the same cells.
#pragma once
#include <span>
#include <vector>

#include "model/tet_mesh.hpp"
#include "model/vec.hpp"

namespace heartgen::adapters {

/// Triangles of the points' x and y, counter-clockwise, smallest node first, ascending. Of points that coincide, one is
/// used. Empty when all points lie on a line.
std::vector<Face> delaunay_triangles(std::span<const Vec3> points);

/// Tetrahedra, positively oriented, smallest node first, ascending. Of points that coincide, one is used.
std::vector<Cell> delaunay_cells(std::span<const Vec3> points);

}  // namespace heartgen::adapters
