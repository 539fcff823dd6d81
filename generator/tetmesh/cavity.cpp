// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/cavity.hpp"

#include <algorithm>
#include <utility>

#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/noise.hpp"
#include "model/contract.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::tetmesh {

std::vector<std::int32_t> nodes_of(const Complex& c, std::span<const std::int32_t> cells) {
  std::vector<std::int32_t> nodes;
  nodes.reserve(4 * cells.size());
  for (const auto t : cells) nodes.insert(nodes.end(), c.cell(t).begin(), c.cell(t).end());
  sort_unique(nodes);
  return nodes;
}

std::vector<std::int32_t> free_cells_around(const Complex& c, std::int32_t id, int rings,
                                            std::span<const std::uint8_t> is_taken) {
  const auto taken = [&](std::int32_t n) { return is_taken[static_cast<std::size_t>(n)] != 0; };
  std::vector<std::int32_t> cells{id};
  for (int ring = 0;; ++ring) {
    const auto nodes = nodes_of(c, cells);
    if (!is_taken.empty() && std::any_of(nodes.begin(), nodes.end(), taken)) return {};
    if (ring == rings) return cells;
    cells.clear();
    for (const auto n : nodes) cells.insert(cells.end(), c.star(n).begin(), c.star(n).end());
    sort_unique(cells);
  }
}

Cavity extract_cavity(const Complex& c, std::vector<std::int32_t> cells) {
  HEARTGEN_EXPECTS(std::is_sorted(cells.begin(), cells.end()));
  Cavity place{std::move(cells), {}, {}};
  place.nodes = nodes_of(c, place.cells);
  auto& part = place.part;
  for (const auto n : place.nodes) {
    const auto star = c.star(n);
    const bool is_inner = std::all_of(star.begin(), star.end(), [&](std::int32_t t) {
      return std::binary_search(place.cells.begin(), place.cells.end(), t);
    });
    part.nodes_mm.push_back(c.at(n));
    part.touches.push_back(c.bits(n));
    part.spacing_mm.push_back(c.spacing_mm[static_cast<std::size_t>(n)]);
    part.frozen.push_back(!is_inner || c.is_frozen(n) ? 1 : 0);
  }
  for (const auto t : place.cells) {
    Cell cell = c.cell(t);
    for (auto& n : cell)
      n = static_cast<std::int32_t>(std::lower_bound(place.nodes.begin(), place.nodes.end(), n) - place.nodes.begin());
    part.cells.push_back(cell);
    part.label.push_back(static_cast<std::uint8_t>(c.label_of(t)));
  }
  connect(part);
  return place;
}

Cavity cavity_around(const Complex& c, std::int32_t cell, int rings) {
  return extract_cavity(c, free_cells_around(c, cell, rings));
}

void reinsert_cavity(Complex& c, Cavity& place, const Complex& changed) {
  for (const auto t : place.cells) remove_cell(c, t);
  for (std::size_t n = 0; n < changed.nodes_mm.size(); ++n) {
    if (n < place.nodes.size()) {
      c.nodes_mm[static_cast<std::size_t>(place.nodes[n])] = changed.nodes_mm[n];
      c.touches[static_cast<std::size_t>(place.nodes[n])] = changed.touches[n];
    } else {
      place.nodes.push_back(add_node(c, changed.nodes_mm[n], changed.touches[n], changed.spacing_mm[n]));
    }
  }
  for (std::size_t t = 0; t < changed.cells.size(); ++t) {
    Cell cell = changed.cells[t];
    if (cell[0] < 0) continue;
    for (auto& n : cell) n = place.nodes[static_cast<std::size_t>(n)];
    add_cell(c, cell, changed.label[t]);
  }
}

void perturb(Complex& part, const Materials& materials, double amplitude, std::uint32_t seed) {
  constexpr double hopeless = 0.1;
  Noise noise{seed};
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(part.nodes_mm.size()); ++n) {
    const double x = noise.next(), y = noise.next(), z = noise.next();
    if (part.is_frozen(n)) continue;
    const double reach = amplitude * static_cast<double>(part.spacing_mm[static_cast<std::size_t>(n)]);
    const Vec3 target = part.at(n) + reach * Vec3{x, y, z};
    const Vec3 place = is_constrained(part.bits(n)) ? project(materials, part.bits(n), target, 3) : target;
    if (norm(place - part.at(n)) < 3 * reach) shift_node(part, n, place - part.at(n), 2, hopeless);
  }
}

double worst_quality(const Complex& complex) {
  double worst = 9;
  for (const auto q : complex.quality) worst = std::min(worst, static_cast<double>(q));
  return worst;
}

}  // namespace heartgen::tetmesh
