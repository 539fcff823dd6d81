// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/orient.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace heartgen::tetmesh {
namespace {

double volume_of(const std::vector<Vec3>& nodes, const Cell& c) {
  const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(c[i])]; };
  return dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0)));
}

/// A face of a cell, its nodes ascending, and which way round the cell sees it.
struct HalfFace {
  Face nodes;
  std::int32_t cell;
  bool is_odd;
  bool operator<(const HalfFace& other) const { return nodes != other.nodes ? nodes < other.nodes : cell < other.cell; }
};

HalfFace half_face(const Cell& cell, std::int32_t id, std::size_t opposite) {
  HalfFace half{{}, id, opposite % 2 == 1};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (i != opposite) half.nodes[count++] = cell[i];
  const auto order = [&](std::size_t i, std::size_t j) {
    if (half.nodes[i] <= half.nodes[j]) return;
    std::swap(half.nodes[i], half.nodes[j]);
    half.is_odd = !half.is_odd;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return half;
}

/// The cell across a face; whether both are written in one order.
struct Neighbour {
  std::int32_t cell = -1;
  bool agrees = true;
};
using Neighbours = std::vector<std::array<Neighbour, 4>>;

Neighbours neighbours_of(const std::vector<Cell>& cells) {
  std::vector<HalfFace> halves;
  halves.reserve(4 * cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i) halves.push_back(half_face(cells[c], static_cast<std::int32_t>(c), i));
  std::sort(halves.begin(), halves.end());
  Neighbours neighbours(cells.size());
  std::vector<std::uint8_t> count(cells.size(), 0);
  const auto add = [&](const HalfFace& to, const HalfFace& from) {
    const auto c = static_cast<std::size_t>(to.cell);
    if (count[c] < 4) neighbours[c][count[c]++] = {from.cell, from.is_odd != to.is_odd};
  };
  for (std::size_t h = 1; h < halves.size(); ++h)
    if (halves[h].nodes == halves[h - 1].nodes) {
      add(halves[h], halves[h - 1]);
      add(halves[h - 1], halves[h]);
    }
  return neighbours;
}

void turn(Cell& cell) { std::swap(cell[2], cell[3]); }

// Turns the cells of the piece around a seed that are not in the seed's order, or all others, whichever leaves the sum
// of the volumes positive.
void orient_piece(const std::vector<Vec3>& nodes_mm, const Neighbours& neighbours, std::int32_t seed,
                  std::vector<std::uint8_t>& seen, std::vector<Cell>& cells) {
  struct Member {
    std::int32_t cell;
    bool agrees;  // with the seed
  };
  std::vector<Member> piece{{seed, true}};
  seen[static_cast<std::size_t>(seed)] = 1;
  double sum = 0;
  for (std::size_t next = 0; next < piece.size(); ++next) {
    const auto [cell, agrees] = piece[next];
    const double volume = volume_of(nodes_mm, cells[static_cast<std::size_t>(cell)]);
    sum += agrees ? volume : -volume;
    for (const auto& [other, is_same] : neighbours[static_cast<std::size_t>(cell)]) {
      if (other < 0 || seen[static_cast<std::size_t>(other)] != 0) continue;
      seen[static_cast<std::size_t>(other)] = 1;
      piece.push_back({other, agrees == is_same});
    }
  }
  for (const auto& [cell, agrees] : piece)
    if (agrees != (sum >= 0)) turn(cells[static_cast<std::size_t>(cell)]);
}

}  // namespace

std::vector<Cell> oriented_cells(const std::vector<Vec3>& nodes_mm, std::vector<Cell> cells) {
  if (std::none_of(cells.begin(), cells.end(), [&](const Cell& c) { return volume_of(nodes_mm, c) < 0; })) return cells;
  const auto neighbours = neighbours_of(cells);
  std::vector<std::uint8_t> seen(cells.size(), 0);
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (seen[c] == 0) orient_piece(nodes_mm, neighbours, static_cast<std::int32_t>(c), seen, cells);
  return cells;
}

}  // namespace heartgen::tetmesh
