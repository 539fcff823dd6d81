// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the lattice mesher is told: several materials in a box. All positions are in mm along the axes of the box.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "model/vec.hpp"

namespace heartgen::tetmesh {

/// A set of labels (bit L: label L, 0 is the outside) and of sides of the box (bit first_side + 2*axis + is_upper).
using LabelBits = std::uint32_t;
constexpr int first_side = 24;
constexpr LabelBits side_bits = 0x3FU << first_side;
constexpr LabelBits bit_of(int label) { return LabelBits{1} << label; }

/// A surface near a point: linear model of a function that is 0 on it.
struct Equation {
  double value = 0;
  Vec3 gradient;  ///< per mm, along the axes of the box
};
constexpr std::size_t max_equations = 6;

/// A ball in which edges are shorter.
struct FineSpot {
  Vec3 center_mm;
  double radius_mm = 0;
  int halvings = 1;  ///< of the edges that are wanted there
};

/// Where each material is. Interfaces are where `label_at` changes; nothing may depend on the order of the calls,
/// which come from several threads.
struct Materials {
  Vec3 box_min_mm, box_max_mm;                 ///< the mesh fills this box at most
  std::function<int(const Vec3&)> label_at;    ///< 0 (outside) to first_side - 1
  std::function<double(const Vec3&)> edge_mm;  ///< wanted edge length, positive
  /// The surfaces on which a point where all of `labels` meet lies, as equations at a nearby point: one less than
  /// there are labels. Returns how many of `equations` were written.
  std::function<int(LabelBits labels, const Vec3& point, std::span<Equation> equations)> equations_at;
  double finest_edge_mm = 0;    ///< the least of edge_mm where it is known, else 0
  std::vector<FineSpot> spots;  ///< where edges are shorter than edge_mm
};

}  // namespace heartgen::tetmesh
