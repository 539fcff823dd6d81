// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/flips.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "generator/mesh/quality.hpp"

namespace heartgen::mesh {
namespace {

constexpr std::size_t longest_ring = 8;
constexpr double min_gain = 1e-6;

struct Flipper {
  const std::vector<Vec3>* nodes;
  std::vector<Cell>* cells;
  std::vector<std::int32_t>* label;
  std::vector<std::uint8_t> alive;
  std::vector<std::vector<std::int32_t>> star;  // living cells around each node

  const Cell& cell(std::int32_t c) const { return (*cells)[static_cast<std::size_t>(c)]; }
  std::int32_t label_of(std::int32_t c) const { return (*label)[static_cast<std::size_t>(c)]; }
  const std::vector<std::int32_t>& around(std::int32_t node) const { return star[static_cast<std::size_t>(node)]; }
  Vec3 at(std::int32_t node) const { return (*nodes)[static_cast<std::size_t>(node)]; }
  double quality(const Cell& c) const { return min_sine({at(c[0]), at(c[1]), at(c[2]), at(c[3])}); }
};

bool has(const Cell& cell, std::int32_t node) { return std::find(cell.begin(), cell.end(), node) != cell.end(); }

void replace(Flipper& f, const std::vector<std::int32_t>& old_cells, const std::vector<Cell>& new_cells) {
  const auto label = f.label_of(old_cells[0]);
  for (const auto c : old_cells) {
    f.alive[static_cast<std::size_t>(c)] = 0;
    for (const auto n : f.cell(c)) std::erase(f.star[static_cast<std::size_t>(n)], c);
  }
  for (const auto& cell : new_cells) {
    const auto id = static_cast<std::int32_t>(f.cells->size());
    f.cells->push_back(cell);
    f.label->push_back(label);
    f.alive.push_back(1);
    for (const auto n : cell) f.star[static_cast<std::size_t>(n)].push_back(id);
  }
}

/// The cells around an edge, and the closed ring of their other nodes, counter-clockwise seen from b.
struct Ring {
  std::vector<std::int32_t> cells, nodes;
};

// For the cell's edge ab: the other two nodes in the order that makes (a, b, u, v) positive.
std::pair<std::int32_t, std::int32_t> others(const Cell& c, std::int32_t a, std::int32_t b) {
  constexpr std::array<std::array<std::size_t, 4>, 12> even{{{0, 1, 2, 3},
                                                             {0, 2, 3, 1},
                                                             {0, 3, 1, 2},
                                                             {1, 0, 3, 2},
                                                             {1, 2, 0, 3},
                                                             {1, 3, 2, 0},
                                                             {2, 0, 1, 3},
                                                             {2, 1, 3, 0},
                                                             {2, 3, 0, 1},
                                                             {3, 0, 2, 1},
                                                             {3, 1, 0, 2},
                                                             {3, 2, 1, 0}}};
  for (const auto& order : even)
    if (c[order[0]] == a && c[order[1]] == b) return {c[order[2]], c[order[3]]};
  return {-1, -1};
}

std::optional<Ring> ring_of(const Flipper& f, std::int32_t a, std::int32_t b, std::int32_t label) {
  Ring ring;
  std::vector<std::pair<std::int32_t, std::int32_t>> links;
  for (const auto c : f.around(a)) {
    if (!has(f.cell(c), b)) continue;
    if (f.label_of(c) != label) return std::nullopt;
    ring.cells.push_back(c);
    links.push_back(others(f.cell(c), a, b));
  }
  if (links.size() < 3 || links.size() > longest_ring) return std::nullopt;
  std::int32_t at = links[0].first;
  for (std::size_t step = 0; step < links.size(); ++step) {
    ring.nodes.push_back(at);
    const auto next = std::find_if(links.begin(), links.end(), [&](const auto& link) { return link.first == at; });
    if (next == links.end()) return std::nullopt;
    at = next->second;
  }
  if (at != ring.nodes[0]) return std::nullopt;  // the edge lies on the hull
  return ring;
}

/// Best triangulation of a ring (Klincsek's recursion): each triangle makes a cell with a and one with b.
struct RingFilling {
  double worst = -1;
  std::vector<Cell> cells;
};

RingFilling fill_ring(const Flipper& f, const std::vector<std::int32_t>& ring, std::int32_t a, std::int32_t b) {
  const std::size_t n = ring.size();
  std::array<std::array<double, longest_ring>, longest_ring> best;
  std::array<std::array<std::size_t, longest_ring>, longest_ring> apex{};
  for (std::size_t i = 0; i + 1 < n; ++i) best[i][i + 1] = std::numeric_limits<double>::max();
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      best[i][j] = -1;
      for (std::size_t k = i + 1; k < j; ++k) {
        double value = std::min(best[i][k], best[k][j]);
        if (value > best[i][j]) value = std::min(value, f.quality({ring[i], ring[k], ring[j], b}));
        if (value > best[i][j]) value = std::min(value, f.quality({ring[i], ring[j], ring[k], a}));
        if (value <= best[i][j]) continue;
        best[i][j] = value;
        apex[i][j] = k;
      }
    }
  RingFilling filling{best[0][n - 1], {}};
  if (filling.worst <= 0) return filling;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const std::size_t k = apex[i][j];
    filling.cells.push_back({ring[i], ring[k], ring[j], b});
    filling.cells.push_back({ring[i], ring[j], ring[k], a});
    open.emplace_back(i, k);
    open.emplace_back(k, j);
  }
  return filling;
}

bool remove_an_edge(Flipper& f, std::int32_t bad) {
  const Cell cell = f.cell(bad);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const auto ring = ring_of(f, cell[i], cell[j], f.label_of(bad));
      if (!ring) continue;
      double old_worst = std::numeric_limits<double>::max();
      for (const auto c : ring->cells) old_worst = std::min(old_worst, f.quality(f.cell(c)));
      const auto filling = fill_ring(f, ring->nodes, cell[i], cell[j]);
      if (filling.worst <= old_worst + min_gain || filling.worst <= 0) continue;
      replace(f, ring->cells, filling.cells);
      return true;
    }
  return false;
}

// Two cells that share the face opposite to `corner` become three around the edge between their apexes.
bool remove_a_face(Flipper& f, std::int32_t bad) {
  const Cell cell = f.cell(bad);
  for (std::size_t corner = 0; corner < 4; ++corner) {
    const std::int32_t first = cell[(corner + 1) % 4], second = cell[(corner + 2) % 4], third = cell[(corner + 3) % 4];
    for (const auto c : f.around(first)) {
      const Cell other = f.cell(c);
      if (c == bad || f.label_of(c) != f.label_of(bad) || !has(other, second) || !has(other, third)) continue;
      const auto far = *std::find_if(other.begin(), other.end(),
                                     [&](std::int32_t n) { return n != first && n != second && n != third; });
      std::vector<Cell> three;
      for (const auto dropped : {first, second, third}) {  // the old cell with this node moved to the far apex
        Cell made = cell;
        std::replace(made.begin(), made.end(), dropped, far);
        three.push_back(made);
      }
      const double old_worst = std::min(f.quality(cell), f.quality(other));
      double worst = std::numeric_limits<double>::max();
      for (const auto& made : three) worst = std::min(worst, f.quality(made));
      if (worst <= old_worst + min_gain || worst <= 0) continue;
      replace(f, {bad, c}, three);
      return true;
    }
  }
  return false;
}

}  // namespace

std::int64_t flip_bad_cells(const std::vector<Vec3>& nodes_mm, std::vector<Cell>& cells,
                            std::vector<std::int32_t>& label, std::int32_t first_dropped_label, double goal) {
  constexpr int max_rounds = 4;
  Flipper f{&nodes_mm, &cells, &label, std::vector<std::uint8_t>(cells.size(), 1),
            std::vector<std::vector<std::int32_t>>(nodes_mm.size())};
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const auto n : cells[c]) f.star[static_cast<std::size_t>(n)].push_back(static_cast<std::int32_t>(c));
  std::int64_t total = 0;
  for (int round = 0; round < max_rounds; ++round) {
    std::int64_t flips = 0;
    const auto count = static_cast<std::int32_t>(cells.size());
    for (std::int32_t c = 0; c < count; ++c) {
      const auto l = f.label_of(c);
      if (!f.alive[static_cast<std::size_t>(c)] || l <= 0 || l >= first_dropped_label) continue;
      if (f.quality(f.cell(c)) < goal) flips += remove_an_edge(f, c) || remove_a_face(f, c);
    }
    total += flips;
    if (flips == 0) break;
  }
  std::size_t kept = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!f.alive[c]) continue;
    cells[kept] = cells[c];
    label[kept++] = label[c];
  }
  cells.resize(kept);
  label.resize(kept);
  return total;
}

}  // namespace heartgen::mesh
