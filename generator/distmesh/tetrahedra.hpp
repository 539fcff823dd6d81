// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The tetrahedra of a truss in three dimensions, ready for repair: the Delaunay criterion does not prevent slivers
/// (thesis 8.2), the lattice mesher's repair takes them away.
#pragma once
#include "generator/distmesh/distmesh.hpp"
#include "generator/tetmesh/complex.hpp"

namespace heartgen::distmesh {

/// Cells with label 0 lie outside: `tetmesh::derive_touches` and `compress` finish the mesh once the labels are
/// settled.
tetmesh::Complex complex_of(const Truss& truss, const Materials& materials);

}  // namespace heartgen::distmesh
