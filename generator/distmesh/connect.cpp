// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/connect.hpp"

#include <algorithm>
#include <span>
#include <tuple>

#include "generator/adapters/cgal_delaunay.hpp"
#include "generator/parallel/gather.hpp"
#include "generator/tetmesh/stars.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::distmesh {

Simplices delaunay(const Nodes& nodes, Dimension dimension) {
  Simplices result;
  if (dimension == Dimension::three) {
    result.cells = adapters::delaunay_cells(nodes.at_mm);
    result.corners = 4;
    return result;
  }
  for (const auto& t : adapters::delaunay_triangles(nodes.at_mm)) result.cells.push_back({t[0], t[1], t[2], -1});
  return result;
}

std::vector<Edge> edges_of(const Simplices& simplices, std::size_t node_count) {
  const auto stars = tetmesh::stars_of(node_count, simplices.cells);
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Edge>& edges) {
    std::vector<std::int32_t> others;
    for (auto node = static_cast<std::int32_t>(begin); node < end; ++node) {
      others.clear();
      for (const auto s : stars.of(node))
        for (const auto n : simplices.cells[static_cast<std::size_t>(s)])
          if (n > node) others.push_back(n);
      sort_unique(others);
      for (const auto n : others) edges.push_back({node, n});
    }
  };
  return parallel::gather<Edge>(0, static_cast<std::int64_t>(node_count), find);
}

namespace {

// The faces of the simplices around a node of which it is the least, nodes and faces ascending.
void collect_faces(const Simplices& simplices, std::span<const std::int32_t> star, std::int32_t node,
                   std::vector<Face>& faces) {
  faces.clear();
  for (const auto s : star) {
    const Cell& cell = simplices.cells[static_cast<std::size_t>(s)];
    for (std::size_t left_out = 0; left_out < simplices.corners; ++left_out) {
      if (cell[left_out] == node) continue;
      Face face{-1, -1, -1};
      for (std::size_t i = 0, k = 0; i < simplices.corners; ++i)
        if (i != left_out) face[k++] = cell[i];
      std::sort(face.begin(), face.end());
      if (face[4 - simplices.corners] == node) faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end());
}

}  // namespace

std::vector<Face> hull_faces(const Simplices& inside) {
  std::int32_t count = 0;
  for (const auto& cell : inside.cells) count = std::max(count, *std::max_element(cell.begin(), cell.end()) + 1);
  const auto stars = tetmesh::stars_of(static_cast<std::size_t>(count), inside.cells);
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Face>& hull) {
    std::vector<Face> faces;
    for (auto node = static_cast<std::int32_t>(begin); node < end; ++node) {
      collect_faces(inside, stars.of(node), node, faces);
      for (std::size_t f = 0; f < faces.size(); ++f)
        if ((f == 0 || faces[f - 1] != faces[f]) && (f + 1 == faces.size() || faces[f + 1] != faces[f]))
          hull.push_back(faces[f]);
    }
  };
  return parallel::gather<Face>(0, count, find);
}

Vec3 center_of(const Nodes& nodes, const Cell& cell, std::size_t corners) {
  Vec3 sum;
  for (std::size_t i = 0; i < corners; ++i) sum += nodes.at_mm[static_cast<std::size_t>(cell[i])];
  return sum / static_cast<double>(corners);
}

int label_of(const Nodes& nodes, const Cell& cell, std::size_t corners, const Materials& materials) {
  LabelBits common = ~tetmesh::side_bits;
  std::size_t on_hull = 0;
  for (std::size_t i = 0; i < corners; ++i) {
    const LabelBits bits = nodes.touches[static_cast<std::size_t>(cell[i])];
    common &= bits;
    on_hull += (bits & (bit_of(0) | tetmesh::side_bits)) != 0 ? 1 : 0;
  }
  if (std::popcount(common) == 1 && on_hull + 1 < corners) return std::countr_zero(common);
  const auto bits = bits_at(materials, center_of(nodes, cell, corners));
  if (is_outside(bits)) return 0;
  return std::countr_zero(std::popcount(common) == 1 ? common : bits);
}

namespace {

/// Beyond each face of each simplex: the simplex there, or -1.
std::vector<Cell> neighbours_of(const Simplices& simplices) {
  struct Side {
    Face nodes;
    std::int32_t simplex, corner;
  };
  std::vector<Side> sides;
  for (std::size_t s = 0; s < simplices.cells.size(); ++s)
    for (std::size_t left_out = 0; left_out < simplices.corners; ++left_out) {
      Side side{{-1, -1, -1}, static_cast<std::int32_t>(s), static_cast<std::int32_t>(left_out)};
      for (std::size_t i = 0, k = 0; i < simplices.corners; ++i)
        if (i != left_out) side.nodes[k++] = simplices.cells[s][i];
      std::sort(side.nodes.begin(), side.nodes.end());
      sides.push_back(side);
    }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return std::tie(a.nodes, a.simplex) < std::tie(b.nodes, b.simplex); });
  std::vector<Cell> neighbours(simplices.cells.size(), Cell{-1, -1, -1, -1});
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const auto &a = sides[i], &b = sides[i + 1];
    if (a.nodes != b.nodes) continue;
    neighbours[static_cast<std::size_t>(a.simplex)][static_cast<std::size_t>(a.corner)] = b.simplex;
    neighbours[static_cast<std::size_t>(b.simplex)][static_cast<std::size_t>(b.corner)] = a.simplex;
  }
  return neighbours;
}

}  // namespace

void absorb_crumbs(const Simplices& simplices, std::vector<std::uint8_t>& label) {
  constexpr std::size_t most = 2;
  const auto neighbours = neighbours_of(simplices);
  for (std::size_t s = 0; s < label.size(); ++s) {
    std::vector<std::size_t> piece{s};
    std::array<int, 256> shared{};
    bool is_open = false;  // towards the hull
    for (std::size_t i = 0; i < piece.size() && piece.size() <= most; ++i)
      for (std::size_t c = 0; c < simplices.corners; ++c) {
        const auto other = neighbours[piece[i]][c];
        if (other < 0) {
          is_open = is_open || label[s] == 0;
          continue;
        }
        const auto o = static_cast<std::size_t>(other);
        if (label[o] != label[s])
          ++shared[label[o]];
        else if (std::find(piece.begin(), piece.end(), o) == piece.end())
          piece.push_back(o);
      }
    if (piece.size() > most || is_open) continue;
    const auto best = std::max_element(shared.begin(), shared.end());
    if (*best == 0) continue;
    for (const auto p : piece) label[p] = static_cast<std::uint8_t>(best - shared.begin());
  }
}

}  // namespace heartgen::distmesh
