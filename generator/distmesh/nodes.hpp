// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Nodes that move, and where they may lie. Two dimensions are three with z = 0: the materials of a plane have
/// equations without a z component and a box without sides in z (see `unbounded_mm`).
#pragma once
#include <bit>
#include <cstdint>
#include <vector>

#include "generator/tetmesh/materials.hpp"
#include "model/vec.hpp"

namespace heartgen::distmesh {

using tetmesh::bit_of;
using tetmesh::LabelBits;
using tetmesh::Materials;

enum class Dimension : std::uint8_t { two = 2, three = 3 };

/// Half the extent of a box along z in two dimensions.
constexpr double unbounded_mm = 1e30;

struct Nodes {
  std::vector<Vec3> at_mm;
  std::vector<LabelBits> touches;  ///< one label: free; more (and sides of the box): bound to where all of them meet
  std::size_t fixed = 0;           ///< the first so many never move

  std::size_t size() const { return at_mm.size(); }
  bool is_free(std::size_t n) const { return std::popcount(touches[n]) == 1; }
};

/// The label at a point, or the side of the box beyond which it lies (farthest).
LabelBits bits_at(const Materials& materials, const Vec3& point);

/// All labels and sides found at `reach_mm` around a point and at the point itself.
LabelBits bits_around(const Materials& materials, Dimension dimension, const Vec3& point, double reach_mm);

/// Whether nothing of the mesh lies there: outside all labels, or beyond the box.
inline bool is_outside(LabelBits bits) { return (bits & ~(bit_of(0) | tetmesh::side_bits)) == 0; }

/// How many equations hold a node that touches these: as many as the dimension fix it.
inline int constraints(LabelBits bits) {
  const int labels = std::popcount(bits & ~tetmesh::side_bits), sides = std::popcount(bits & tetmesh::side_bits);
  return std::max(labels - 1, 0) + sides;
}

}  // namespace heartgen::distmesh
