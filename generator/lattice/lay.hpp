// A lattice over the box of some materials, before anything is made of it: which leaves, and where their nodes lie.
#pragma once
#include "generator/lattice/materials.hpp"
#include "generator/lattice/near_leaves.hpp"
#include "generator/lattice/octree.hpp"

namespace heart::lattice {

struct Lattice {
  Octree tree;
  NearLeaves near;
};

/// The same whatever the materials' spots.
WantedLevels wanted_levels(const Materials& materials);

/// The same result for any number of threads.
Lattice lay_lattice(const Materials& materials, const WantedLevels& wanted);

Lattice lay_lattice(const Materials& materials);

}  // namespace heart::lattice
