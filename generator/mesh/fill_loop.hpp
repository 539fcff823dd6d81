// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A closed line filled with triangles between its own nodes.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

/// Triangles of least area between the nodes of a loop, of equal ones those with short sides; each contains the loop's
/// edges in the loop's own direction, and the same triangles come, turned, for the loop read backwards. No two of them
/// are joined by an edge that `is_taken` (the two nodes, the smaller first), where that can be. The dynamic programme
/// of Barequet and Sharir, Filling gaps in the boundary of a polyhedron, CAGD 12:207 (1995): cubic in the nodes.
std::vector<Face> fill_loop(const std::vector<Vec3>& nodes_mm, const std::vector<std::int32_t>& loop,
                            const std::function<bool(std::int32_t, std::int32_t)>& is_taken);

}  // namespace heartgen::mesh
