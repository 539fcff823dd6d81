// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Raises the worst cells of a mesh of several materials: smoothing, exchange of edges and faces, contraction,
/// division, and at last small shakes; sweeps over the bad cells only. Klingner and Shewchuk 2007 (Stellar).
#pragma once
#include <cstdint>
#include <limits>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"

namespace heartgen::tetmesh {

struct RepairSettings {
  double goal = 0.512;   ///< quality (see quality.hpp) that every cell should have: angles in [30.8, 143] degrees
  double least = 0.512;  ///< cells below this are worth the costly shakes
  int sweeps = 12;       ///< at most
  double middle = 0.1;   ///< of the lattice's width: how far the middle of a new edge may leave its surface
  double face = std::numeric_limits<double>::infinity();  ///< how far faces that fit may leave surfaces, in edges
  bool may_relabel = true;  ///< thin tips of a region may change to the region that they stick into
  std::int64_t budget = std::numeric_limits<std::int64_t>::max();  ///< attempts on bad cells at most
  double tolerance = 0.15;  ///< of the lattice's width: how far nodes may leave surfaces in the last sweeps
};

/// Never makes the worst cell worse. Nodes that touch several labels keep to their surfaces and curves. The same
/// result for any number of threads. Returns how many cells stay below the goal.
std::int64_t repair(Complex& complex, const Materials& materials, const RepairSettings& settings);

}  // namespace heartgen::tetmesh
