// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The part of a lattice that lies near materials: most of a box is often outside, and its cells need not be made.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "generator/stuffing/octree.hpp"

namespace heartgen::stuffing {

/// Labels of the lattice's nodes, and which leaves are near.
struct NearLeaves {
  std::vector<std::uint8_t> corner_label;  ///< at Octree::corner_offset; 0 where no leaf has a corner
  std::vector<std::uint8_t> center_label;  ///< at Octree::offset of a leaf's first finest cell
  std::vector<std::uint8_t> is_near;       ///< same place: whether its cells are wanted
  bool contains(const Octree& tree, const TreeIndex& finest_cell) const {
    return is_near[tree.offset(tree.leaf_over(finest_cell).low)] != 0;
  }
};

/// Near are all leaves with a cell that shares a node with a cell that has a labelled node (one with a label other than
/// 0). Such a cell either has a corner in a leaf with a labelled node, or its centre is that of a leaf beside one: near
/// are the leaves that share a corner with a labelled one, and those two steps over faces away from one. `label_at` is
/// called from several threads.
NearLeaves active_leaves(const Octree& tree, const std::function<int(const Vec3&)>& label_at);

/// What leaves have in common.
enum class Sharing { corner, face };

/// Makes those leaves near that share something with some; returns which were not, in any order.
std::vector<Leaf> add_leaves_around(const Octree& tree, const std::vector<Leaf>& leaves, Sharing sharing,
                                    NearLeaves& near);

}  // namespace heartgen::stuffing
