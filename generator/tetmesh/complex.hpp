// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A tetrahedral mesh that can be changed: cells come and go, and every node knows its cells.
///
/// The labels of the cells are the truth about where materials are. A node `touches` the labels of its cells, the
/// outside (bit 0) where the mesh ends, and the sides of the box on which it lies; this set decides how it may move.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "generator/tetmesh/materials.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::tetmesh {

/// Marks nodes that lie beside cells of the lattice that were left out because they are outside.
constexpr LabelBits hull_bit = LabelBits{1} << 30;

struct Complex {
  std::vector<Vec3> nodes_mm;
  std::vector<LabelBits> touches;  ///< per node
  std::vector<float> spacing_mm;   ///< per node: the lattice's width there
  /// Per node, or empty: 1 where it stays, with the edges of surfaces between two such nodes.
  std::vector<std::uint8_t> frozen;
  std::vector<Cell> cells;  ///< positively oriented; first node -1: no cell
  std::vector<std::uint8_t> label;
  std::vector<float> quality;  ///< of each cell, 9 where there is none

  /// The cells of node n: pool[first[n]] to pool[first[n] + count[n] - 1], in no particular but a repeatable order.
  std::vector<std::int32_t> first;
  std::vector<std::uint16_t> count, capacity;
  std::vector<std::int32_t> pool;
  std::vector<std::int32_t> free_cells;

  std::span<const std::int32_t> star(std::int32_t node) const {
    const auto n = static_cast<std::size_t>(node);
    return {pool.data() + first[n], count[n]};
  }
  const Vec3& at(std::int32_t node) const { return nodes_mm[static_cast<std::size_t>(node)]; }
  LabelBits bits(std::int32_t node) const { return touches[static_cast<std::size_t>(node)]; }
  const Cell& cell(std::int32_t c) const { return cells[static_cast<std::size_t>(c)]; }
  int label_of(std::int32_t c) const { return label[static_cast<std::size_t>(c)]; }
  double quality_of(std::int32_t c) const { return static_cast<double>(quality[static_cast<std::size_t>(c)]); }
  bool is_frozen(std::int32_t node) const { return !frozen.empty() && frozen[static_cast<std::size_t>(node)] != 0; }
  bool is_alive(std::int32_t c) const { return cells[static_cast<std::size_t>(c)][0] >= 0; }
};

inline bool has(const Cell& cell, std::int32_t node) {
  return cell[0] == node || cell[1] == node || cell[2] == node || cell[3] == node;
}

/// Fills the stars from the cells, of which all must be alive.
void connect_stars(Complex& complex);

/// Fills the stars and qualities from nodes and cells.
void connect(Complex& complex);

std::int32_t add_node(Complex& complex, const Vec3& position, LabelBits touches, float spacing_mm);
std::int32_t add_cell(Complex& complex, const Cell& cell, int label);
/// Its quality is unknown until `connect` or update_quality.
std::int32_t add_unrated_cell(Complex& complex, const Cell& cell, int label);
void remove_cell(Complex& complex, std::int32_t cell);
double quality(const Complex& complex, const Cell& cell);
void update_quality(Complex& complex, std::int32_t cell);
void update_qualities(Complex& complex, std::span<const std::int32_t> cells);  ///< all must be alive
double worst_quality(const Complex& complex, std::span<const std::int32_t> cells);

/// Moves a node where no cell around it falls below `min_quality` or, if one is below already, below the worst.
/// Returns whether it did.
bool move_node(Complex& complex, std::int32_t node, const Vec3& position, double min_quality);

/// Moves a node the whole way or, halved at most `tries - 1` times, as much of it as leaves no cell around below
/// `min_quality` or, if one is below already, below the worst. Returns whether it moved.
bool shift_node(Complex& complex, std::int32_t node, Vec3 way_mm, int tries, double min_quality);

/// Sets `touches` from the labels of the cells; sides are kept, and `hull_bit` becomes a touch of the outside.
void derive_touches(Complex& complex);

/// Whether `touches` is what derive_touches makes of the cells; touches of the outside, which no cell tells, apart.
bool has_derived_touches(const Complex& complex);

/// Whether every node touches at least the labels of its cells. Repairs keep that; touches that a cell has left behind
/// stay until derive_touches.
bool touches_hold_labels(const Complex& complex);

/// Drops free slots, cells with `label` 0 and nodes without cells; keeps the order, and the qualities where there is
/// one for each cell. Leaves the stars as they were.
void drop_unused(Complex& complex);

/// drop_unused and connect.
void compress(Complex& complex);

/// For two nodes of a cell: the other two, such that (a, b, first, second) is positive.
std::pair<std::int32_t, std::int32_t> others(const Cell& cell, std::int32_t a, std::int32_t b);

bool is_edge(const Complex& complex, std::int32_t a, std::int32_t b);

/// The cells with the face (a, b, c): at most two; -1 where there is none.
std::array<std::int32_t, 2> cells_at_face(const Complex& complex, std::int32_t a, std::int32_t b, std::int32_t c);

/// What lies beyond a face that has one cell only: the side of the box that its nodes share, else the outside.
LabelBits beyond_face(const Complex& complex, std::int32_t a, std::int32_t b, std::int32_t c);

}  // namespace heartgen::tetmesh
