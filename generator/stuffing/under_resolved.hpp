// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The part of a lattice whose nodes may be too far apart for what is there.
#pragma once
#include <cstdint>
#include <vector>

#include "generator/stuffing/background_lattice.hpp"

namespace heartgen::stuffing {

/// What is stuffed of a part tells, at a fraction of the work for all, where edges are too long for a label.
struct LatticePart {
  Lattice lattice;                    ///< the same tree, but only leaves of the part and around it are near
  std::vector<std::uint8_t> is_core;  ///< whether a leaf is of the part, at Octree::offset of its first finest cell
};

/// The leaves at ridges, tips and pockets: where a node has its label in common with fewer of its eight nearest
/// neighbours than it would behind a surface that is nearly flat.
LatticePart under_resolved_part(const Lattice& lattice);

/// Whether a position of the box lies in a leaf of the part.
bool is_in_core(const LatticePart& part, const Vec3& position_mm);

}  // namespace heartgen::stuffing
