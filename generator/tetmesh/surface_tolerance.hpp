// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How far from its surfaces what changes may end up.
#pragma once
#include <limits>

namespace heartgen::tetmesh {

struct SurfaceTolerance {
  double node = 0;      ///< in lattice widths, where a node is smoothed; 0: it is projected onto its surfaces
  double middle = 0.1;  ///< of a new edge, in lattice widths
  double face = std::numeric_limits<double>::infinity();  ///< of a face that fits, in its edges: it must go on to do so
};

}  // namespace heartgen::tetmesh
