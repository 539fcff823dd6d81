// The tetrahedra of a truss in three dimensions, ready for repair: the Delaunay criterion does not prevent slivers
// (thesis 8.2), the lattice mesher's repair takes them away.
#pragma once
#include "generator/distmesh/distmesh.hpp"
#include "generator/lattice/complex.hpp"

namespace heart::distmesh {

/// Cells with label 0 lie outside: `lattice::derive_touches` and `compress` finish the mesh once the labels are
/// settled.
lattice::Complex complex_of(const Truss& truss, const Materials& materials);

}  // namespace heart::distmesh
