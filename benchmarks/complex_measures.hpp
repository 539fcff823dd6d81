// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the mesh benchmarks measure on a complex of the lattice mesher.
#pragma once
#include <cstdint>

#include "benchmarks/mesh_measures.hpp"
#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::benchmarks {

Angles angles_of(const tetmesh::Complex& complex);

/// Of the cells with this label, mm^3.
double volume_of(const tetmesh::Complex& complex, int label);

/// Of the outer faces' centres to the surface of one material, to first order, in shares of the face's mean edge. Faces
/// in the sides of the box do not count.
Distances distances_of(const tetmesh::Complex& complex, const tetmesh::Materials& materials);

/// Edges with other than two outer faces, and faces with more than two cells.
std::int64_t defects_of(const tetmesh::Complex& complex);

}  // namespace heartgen::benchmarks
