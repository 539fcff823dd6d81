#include "generator/lattice/rescue.hpp"

#include <algorithm>
#include <vector>

#include "generator/lattice/feature.hpp"
#include "generator/lattice/noise.hpp"

namespace heart::lattice {
namespace {

constexpr int rings = 3;  // of cells around a bad one
constexpr int most_tries = 12;

/// Some cells of a complex as a complex of their own, whose outer nodes stay where they are.
struct Place {
  std::vector<std::int32_t> cells, nodes;  // ids in the whole, ascending
  Complex part;
};

template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

std::vector<std::int32_t> cells_around(const Complex& c, std::int32_t id) {
  std::vector<std::int32_t> cells{id}, nodes;
  for (int ring = 0; ring < rings; ++ring) {
    nodes.clear();
    for (const auto t : cells) nodes.insert(nodes.end(), c.cell(t).begin(), c.cell(t).end());
    sort_unique(nodes);
    cells.clear();
    for (const auto n : nodes) cells.insert(cells.end(), c.star(n).begin(), c.star(n).end());
    sort_unique(cells);
  }
  return cells;
}

Place place_around(const Complex& c, std::int32_t id) {
  Place place{cells_around(c, id), {}, {}};
  for (const auto t : place.cells) place.nodes.insert(place.nodes.end(), c.cell(t).begin(), c.cell(t).end());
  sort_unique(place.nodes);
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

// Moves every node that may move a little, where no cell becomes hopeless.
void shake_up(Complex& c, const Materials& materials, double amplitude, std::uint32_t seed) {
  constexpr double hopeless = 0.1;
  Noise noise{seed};
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(c.nodes_mm.size()); ++n) {
    const double x = noise.next(), y = noise.next(), z = noise.next();
    if (c.is_frozen(n)) continue;
    const double reach = amplitude * static_cast<double>(c.spacing_mm[static_cast<std::size_t>(n)]);
    const Vec3 target = c.at(n) + reach * Vec3{x, y, z};
    const Vec3 place = is_constrained(c.bits(n)) ? project(materials, c.bits(n), target, 3) : target;
    if (norm(place - c.at(n)) < 3 * reach) shift_node(c, n, place - c.at(n), 2, hopeless);
  }
}

double worst_of(const Complex& c) {
  double worst = 9;
  for (const auto q : c.quality) worst = std::min(worst, static_cast<double>(q));
  return worst;
}

// The best of some repairs of a place.
Complex best_repair(const Complex& part, const Materials& materials, RepairSettings settings, double enough) {
  settings.may_relabel = false;  // labels beyond the place are not seen
  settings.least = settings.goal;
  settings.sweeps *= 2;
  Complex best = part;
  for (int attempt = 0; attempt < most_tries && worst_of(best) < enough; ++attempt) {
    Complex tried = part;
    if (attempt > 0) shake_up(tried, materials, 0.04 + 0.04 * (attempt % 4), static_cast<std::uint32_t>(attempt));
    repair(tried, materials, settings);
    if (worst_of(tried) > worst_of(best)) best = std::move(tried);
  }
  return best;
}

void put_back(Complex& c, Place& place, const Complex& repaired) {
  for (const auto t : place.cells) remove_cell(c, t);
  for (std::size_t n = 0; n < repaired.nodes_mm.size(); ++n) {
    if (n < place.nodes.size())
      c.nodes_mm[static_cast<std::size_t>(place.nodes[n])] = repaired.nodes_mm[n];
    else
      place.nodes.push_back(add_node(c, repaired.nodes_mm[n], repaired.touches[n], repaired.spacing_mm[n]));
  }
  for (std::size_t t = 0; t < repaired.cells.size(); ++t) {
    Cell cell = repaired.cells[t];
    if (cell[0] < 0) continue;
    for (auto& n : cell) n = place.nodes[static_cast<std::size_t>(n)];
    add_cell(c, cell, repaired.label[t]);
  }
}

// The worst first.
std::vector<std::int32_t> cells_below(const Complex& c, double enough) {
  std::vector<std::int32_t> bad;
  for (std::size_t i = 0; i < c.quality.size(); ++i)
    if (static_cast<double>(c.quality[i]) < enough) bad.push_back(static_cast<std::int32_t>(i));
  std::stable_sort(bad.begin(), bad.end(), [&](auto a, auto b) { return c.quality_of(a) < c.quality_of(b); });
  return bad;
}

}  // namespace

std::int64_t rescue(Complex& complex, const Materials& materials, const RepairSettings& settings, double enough) {
  constexpr std::size_t most_cells = 30;  // more are not a few: the whole has to be made in another way
  const auto bad = cells_below(complex, enough);
  if (bad.size() > most_cells) return static_cast<std::int64_t>(bad.size());
  for (const auto id : bad) {
    if (!complex.is_alive(id) || complex.quality_of(id) >= enough) continue;
    auto place = place_around(complex, id);
    const auto repaired = best_repair(place.part, materials, settings, enough);
    if (worst_of(repaired) > worst_of(place.part)) put_back(complex, place, repaired);
    if (worst_of(repaired) < enough) break;  // nothing makes the whole good enough now
  }
  return static_cast<std::int64_t>(cells_below(complex, enough).size());
}

}  // namespace heart::lattice
