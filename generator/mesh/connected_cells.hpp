// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: cells and the cells of their nodes, for work on labels.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "generator/tetmesh/stars.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

inline bool has(const Cell& cell, std::int32_t n) {
  return cell[0] == n || cell[1] == n || cell[2] == n || cell[3] == n;
}

constexpr std::array<std::array<std::size_t, 3>, 4> face_corners{{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

/// Per node, whether a cell around it has changed.
using Changes = std::vector<std::uint8_t>;

constexpr std::int32_t hull = -1;

struct Tetrahedra {
  const std::vector<Vec3>* nodes;
  const std::vector<Cell>* cells;
  std::vector<std::int32_t>* label;
  tetmesh::Stars stars;
  Changes is_mixed;  // nodes that several labels may meet

  std::int32_t label_of(std::int32_t cell) const { return (*label)[static_cast<std::size_t>(cell)]; }
  const Cell& cell(std::int32_t c) const { return (*cells)[static_cast<std::size_t>(c)]; }
  /// The cell beyond the face opposite to a corner, or `hull`.
  std::int32_t across(std::int32_t c, std::size_t corner) const {
    return across_among(stars.of(cell(c)[face_corners[corner][0]]), c, corner);
  }
  /// The same where all cells of one of the face's nodes are known.
  std::int32_t across_among(std::span<const std::int32_t> star, std::int32_t c, std::size_t corner) const;
  std::int32_t label_across(std::int32_t c, std::size_t corner) const {
    const auto other = across(c, corner);
    return other == hull ? 0 : label_of(other);
  }
  const Vec3& corner(std::int32_t c, std::size_t i) const { return (*nodes)[static_cast<std::size_t>(cell(c)[i])]; }
  double volume(std::int32_t c) const {
    const Vec3& o = corner(c, 0);
    return std::abs(dot(corner(c, 1) - o, cross(corner(c, 2) - o, corner(c, 3) - o))) / 6;
  }
  double face_area(std::int32_t c, std::size_t opposite) const {
    const auto& [i, j, k] = face_corners[opposite];
    return norm(cross(corner(c, j) - corner(c, i), corner(c, k) - corner(c, i))) / 2;
  }
};

/// All must outlive the result.
Tetrahedra connect(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells, std::vector<std::int32_t>& label);

}  // namespace heartgen::mesh
