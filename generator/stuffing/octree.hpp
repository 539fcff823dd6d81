// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A graded octree of a box: the size of its leaves follows an edge length, and leaves that share an edge differ by at
/// most a factor of two. Its root cells fill the box exactly, so that the sides of the box are planes of the lattice.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "generator/tetmesh/materials.hpp"

namespace heartgen::stuffing {

using TreeIndex = std::array<std::int32_t, 3>;

/// A leaf covers 2^level finest cells along each axis, from finest cell `low` on.
struct Leaf {
  TreeIndex low;
  std::int32_t level = 0;
};

/// Corner 0 is the first, `low`; bits 0 to 2 tell the upper ones along x, y, z.
inline TreeIndex corner_of(const Leaf& leaf, std::int32_t corner) {
  return {leaf.low[0] + ((corner & 1) << leaf.level), leaf.low[1] + ((corner >> 1 & 1) << leaf.level),
          leaf.low[2] + ((corner >> 2) << leaf.level)};
}

struct Octree {
  Vec3 origin_mm;                   ///< lower corner of the box
  Vec3 step_mm;                     ///< size of the finest cells; a few percent of difference between the axes
  TreeIndex size{0, 0, 0};          ///< finest cells along each axis
  std::vector<Leaf> leaves;         ///< along a space-filling curve inside each root cell
  std::vector<std::uint8_t> level;  ///< of the leaf over each finest cell, x fastest

  std::size_t offset(const TreeIndex& at) const {
    return (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(at[1])) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(at[0]);
  }
  /// Corners of finest cells, the last ones included.
  std::size_t corner_offset(const TreeIndex& at) const {
    const auto nx = static_cast<std::size_t>(size[0]) + 1, ny = static_cast<std::size_t>(size[1]) + 1;
    return (static_cast<std::size_t>(at[2]) * ny + static_cast<std::size_t>(at[1])) * nx +
           static_cast<std::size_t>(at[0]);
  }
  bool contains(const TreeIndex& at) const {
    return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < size[0] && at[1] < size[1] && at[2] < size[2];
  }
  /// The leaf over a finest cell. (Leaves begin at multiples of their width.)
  Leaf leaf_over(const TreeIndex& at) const {
    const std::int32_t number = level[offset(at)], rest = (1 << number) - 1;
    return {{at[0] & ~rest, at[1] & ~rest, at[2] & ~rest}, number};
  }
  /// The finest cell over a position, or beside the box where that lies beyond it.
  TreeIndex finest_cell_at(const Vec3& p_mm) const {
    const auto along = [](double way_mm, double step) { return static_cast<std::int32_t>(std::floor(way_mm / step)); };
    return {along(p_mm.x - origin_mm.x, step_mm.x), along(p_mm.y - origin_mm.y, step_mm.y),
            along(p_mm.z - origin_mm.z, step_mm.z)};
  }
  /// Places are in finest cells, and may lie between their corners.
  Vec3 position_mm(const std::array<double, 3>& at) const {
    return {origin_mm.x + at[0] * step_mm.x, origin_mm.y + at[1] * step_mm.y, origin_mm.z + at[2] * step_mm.z};
  }
};

/// Whether a leaf has a corner there.
bool is_leaf_corner(const Octree& tree, const TreeIndex& at);

/// Mean edge of a BCC lattice whose cubes have edges of length 1 (8 edges of sqrt(3)/2 and 6 of 1 at each node).
constexpr double mean_edge_per_cell = 0.9235;

/// Cells for each cube of the lattice inside a body: 12, and what the surface adds at usual sizes.
constexpr double cells_per_cube = 13.5;

/// The cells of one size that fill a box.
struct BoxCells {
  Vec3 origin_mm;           ///< lower corner of the box
  Vec3 step_mm;             ///< of the cells along the axes
  TreeIndex size{0, 0, 0};  ///< cells along each axis
  double mean_step_mm = 0;  ///< before rounding
  std::int32_t root = 0;    ///< level of the root cells, 2^root of these cells wide
};

/// The finest cells of a box that are needed without spots, and the level (BoxCells::root at most) that the edge at the
/// centre of each allows, x fastest.
struct WantedLevels {
  BoxCells cells;
  std::vector<std::uint8_t> level;
};

/// `finest_edge_mm` is the smallest value of edge_mm, which is called from several threads.
WantedLevels wanted_levels(const Vec3& box_min_mm, const Vec3& box_max_mm, double finest_edge_mm,
                           const std::function<double(const Vec3&)>& edge_mm);

/// Leaves are as large as `edge_mm` allows: the mean edge of the lattice is about it, between 0.7 and 1.4 of it. In the
/// spots edges are halved, as far as there is room for an entry for each finest cell of the box; elsewhere leaves are
/// what they are without spots, but for the grading around these.
Octree make_octree(const WantedLevels& wanted, const std::function<double(const Vec3&)>& edge_mm,
                   const std::vector<tetmesh::FineSpot>& spots = {});

}  // namespace heartgen::stuffing
