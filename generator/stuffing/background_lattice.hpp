// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A lattice over the box of some materials, before anything is made of it: which leaves, and where their nodes lie.
#pragma once
#include "generator/stuffing/active_leaves.hpp"
#include "generator/stuffing/octree.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::stuffing {

struct Lattice {
  Octree tree;
  NearLeaves near;
};

/// The same whatever the materials' spots.
WantedLevels wanted_levels(const tetmesh::Materials& materials);

/// The same result for any number of threads.
Lattice build_background_lattice(const tetmesh::Materials& materials, const WantedLevels& wanted);

Lattice build_background_lattice(const tetmesh::Materials& materials);

}  // namespace heartgen::stuffing
