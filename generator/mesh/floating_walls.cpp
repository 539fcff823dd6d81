// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/floating_walls.hpp"

#include <algorithm>
#include <numeric>

#include "generator/mesh/connected_cells.hpp"

namespace heartgen::mesh {
namespace {

constexpr double min_share = 0.02;  // of the walls' volume: a part of a heart, no crumb of the mesher

using Piece = std::vector<std::int32_t>;  // cells

std::int32_t root(std::vector<std::int32_t>& parent, std::int32_t n) {
  while (parent[static_cast<std::size_t>(n)] != n) {
    auto& above = parent[static_cast<std::size_t>(n)];
    above = parent[static_cast<std::size_t>(above)];
    n = above;
  }
  return n;
}

double volume_of(const std::vector<Vec3>& nodes, const Cell& cell) {
  const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(cell[i])]; };
  return std::abs(dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0)))) / 6;
}

/// Sets of cells that hang together through nodes, in the order of their first cells.
std::vector<Piece> pieces_of(std::size_t nodes, const std::vector<Cell>& cells, const auto& is_wall) {
  std::vector<std::int32_t> parent(nodes);
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (is_wall(c))
      for (std::size_t i = 1; i < 4; ++i)
        parent[static_cast<std::size_t>(root(parent, cells[c][i]))] = root(parent, cells[c][0]);
  std::vector<std::int32_t> number(nodes, -1);
  std::vector<Piece> pieces;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!is_wall(c)) continue;
    auto& piece = number[static_cast<std::size_t>(root(parent, cells[c][0]))];
    if (piece < 0) {
      piece = static_cast<std::int32_t>(pieces.size());
      pieces.emplace_back();
    }
    pieces[static_cast<std::size_t>(piece)].push_back(static_cast<std::int32_t>(c));
  }
  return pieces;
}

/// The label, no wall, over most of the piece's outer faces; -1 where there is none.
std::int32_t label_around(const Tetrahedra& t, const Piece& piece, const LabelSet& walls) {
  constexpr std::size_t labels = 32;  // without the layer around the image
  std::array<double, labels> area{};
  for (const auto cell : piece)
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const auto other = static_cast<std::size_t>(t.label_across(cell, corner));
      if (other < labels && !walls[other]) area[other] += t.face_area(cell, corner);
    }
  const auto most = std::max_element(area.begin(), area.end());
  return *most > 0 ? static_cast<std::int32_t>(most - area.begin()) : -1;
}

}  // namespace

std::int64_t absorb_floating_walls(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                                   std::vector<std::int32_t>& label, const LabelSet& walls) {
  const auto pieces =
      pieces_of(nodes_mm.size(), cells, [&](std::size_t c) { return walls[static_cast<std::size_t>(label[c])]; });
  if (pieces.size() < 2) return 0;
  std::vector<double> volumes;
  for (const auto& piece : pieces)
    volumes.push_back(std::accumulate(piece.begin(), piece.end(), 0.0, [&](double sum, std::int32_t c) {
      return sum + volume_of(nodes_mm, cells[static_cast<std::size_t>(c)]);
    }));
  const double all = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  const auto main = static_cast<std::size_t>(std::max_element(volumes.begin(), volumes.end()) - volumes.begin());
  const auto t = connect(nodes_mm, cells, label);
  std::int64_t changed = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (p == main || volumes[p] >= min_share * all) continue;
    const auto other = label_around(t, pieces[p], walls);
    if (other < 0) continue;
    for (const auto c : pieces[p]) label[static_cast<std::size_t>(c)] = other;
    changed += std::ssize(pieces[p]);
  }
  return changed;
}

}  // namespace heartgen::mesh
