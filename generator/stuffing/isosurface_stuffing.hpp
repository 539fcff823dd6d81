// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// From materials to a conforming mesh of a graded lattice whose faces follow the interfaces.
///
/// 1. The background lattice is laid over the box; nodes take the label of their place; cells outside are left out.
/// 2. Snapping: a lattice edge whose ends have no label in common crosses an interface. Where three materials meet in a
///    face, the nearest of its nodes moves onto the curve; then, nearest first, nodes move onto the surface that an
///    edge of theirs crosses near them. A node that has moved touches the labels of both sides, so that its edges do
///    not cross any more. No move may flatten a cell.
/// 3. Cutting: edges that still cross are divided where they do, also those beside a surface whose ends have a label in
///    common but go through a thin sheet of another material. Then nearly every cell has a label common to its
///    nodes; the others take the label of their centre. The labels of the cells are conforming by construction.
/// Snapping before cutting: Labelle and Shewchuk 2007; several materials, features of higher order first: Bronson,
/// Levine and Whitaker 2014 (lattice cleaving), whose stencils general edge division replaces here.
#pragma once
#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::stuffing {

struct Lattice;

struct StuffSettings {
  double edge_reach = 0.5;   ///< nodes snap to crossings nearer than this share of the edge
  double curve_reach = 0.5;  ///< nodes snap to curves nearer than this share of the lattice's width
  double min_quality = 0.1;  ///< no snap makes a cell worse than this (or than it is)
};

/// Cells with label 0 lie outside next to the others; `derive_touches` and `compress` finish the mesh once the labels
/// are settled, and know the cells of its nodes only then. `touches` holds sides and hull only. The same result for any
/// number of threads.
tetmesh::Complex stuff_isosurfaces(const tetmesh::Materials& materials, const Lattice& lattice,
                                   const StuffSettings& settings);
tetmesh::Complex stuff_isosurfaces(const tetmesh::Materials& materials, const StuffSettings& settings);

}  // namespace heartgen::stuffing
