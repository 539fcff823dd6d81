// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where the outside is narrow, two sheets of the outer surface can pass through each other: no cell lies between them
/// that would turn over. Every cell is sound then, but the mesh overlaps itself.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "generator/tetmesh/complex.hpp"

namespace heartgen::surface_fit {

/// Faces with nothing but the outside beyond them, seen from there anticlockwise; without those in a side of the box.
std::vector<Face> outer_faces(const tetmesh::Complex& complex);

/// Two faces by their places in a list, the lower one first.
using FacePair = std::pair<std::int32_t, std::int32_t>;

/// The pairs of faces that meet without sharing what they meet in, ascending.
std::vector<FacePair> self_intersecting_faces(const std::vector<Vec3>& nodes_mm, const std::vector<Face>& faces);

/// Draws outer faces that meet others without sharing what they meet in back into the mesh, where no cell falls below
/// `min_quality` or, if it is below already, gets worse. Returns how many pairs of faces still meet. The same result
/// for any number of threads.
std::int64_t resolve_self_intersections_gently(tetmesh::Complex& complex, double min_quality);

/// The same; where that does not do, cells may come down to angles in [29, 145] degrees, and where that does not do
/// either, cells behind such faces are given to the outside: a worse cell or a missing one is better than an overlap.
std::int64_t resolve_self_intersections(tetmesh::Complex& complex, double min_quality);

}  // namespace heartgen::surface_fit
