// Private to this folder: cells, their neighbours and the cells of their nodes, for work on labels.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "generator/lattice/stars.hpp"
#include "model/tet_mesh.hpp"

namespace heart::mesh {

constexpr std::array<std::array<std::size_t, 3>, 4> face_corners{{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};

/// Per node, whether a cell around it has changed.
using Changes = std::vector<std::uint8_t>;

constexpr std::int32_t hull = -1, unknown = -2;

struct Tetrahedra {
  const std::vector<Vec3>* nodes;
  const std::vector<Cell>* cells;
  std::vector<std::int32_t>* label;
  lattice::Stars stars;
  Changes is_mixed;                                     // nodes that several labels meet, at the start
  std::vector<std::array<std::int32_t, 4>> neighbours;  // across the face opposite to each corner

  std::int32_t label_of(std::int32_t cell) const { return (*label)[static_cast<std::size_t>(cell)]; }
  const Cell& cell(std::int32_t c) const { return (*cells)[static_cast<std::size_t>(c)]; }
  /// The cell beyond a face, or `hull`. Labels change at a few places: only there neighbours are known beforehand.
  std::int32_t across(std::int32_t c, std::size_t corner) const {
    const auto known = neighbours[static_cast<std::size_t>(c)][corner];
    return known != unknown ? known : find_across(c, corner);
  }
  std::int32_t find_across(std::int32_t c, std::size_t corner) const;
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

}  // namespace heart::mesh
