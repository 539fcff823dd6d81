// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/repair.hpp"

#include <algorithm>
#include <vector>

#include "generator/tetmesh/collapse.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/flips.hpp"
#include "generator/tetmesh/noise.hpp"
#include "generator/tetmesh/slabs.hpp"
#include "generator/tetmesh/smooth.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::tetmesh {
namespace {

// When each operation joins in. Cheap and harmless ones come first: most bad cells need no more.
constexpr int contract_from = 1, loosen_from = 1, divide_from = 3, regional_from = 4, shake_from = 6;

std::vector<std::int32_t> bad_cells(const Complex& c, double goal) {
  std::vector<std::int32_t> bad;
  for (std::size_t i = 0; i < c.quality.size(); ++i)
    if (static_cast<double>(c.quality[i]) < goal) bad.push_back(static_cast<std::int32_t>(i));
  return bad;
}

std::vector<std::int32_t> nodes_around(const Complex& c, const Cell& cell) {
  std::vector<std::int32_t> nodes;
  for (const auto corner : cell)
    for (const auto t : c.star(corner)) nodes.insert(nodes.end(), c.cell(t).begin(), c.cell(t).end());
  sort_unique(nodes);
  return nodes;
}

struct Sweep {
  Complex* complex;
  const Materials* materials;
  double goal;
  int number;
  SurfaceTolerance surface;
  std::int64_t* budget;

  /// Counts an attempt on a cell; false once there are none left.
  bool may_try(std::int32_t cell) const { return is_bad(cell) && (*budget)-- > 0; }
  bool is_bad(std::int32_t cell) const { return complex->is_alive(cell) && complex->quality_of(cell) < goal; }

  void smooth_corners(std::int32_t id) const {
    const Cell cell = complex->cell(id);
    for (const auto n : cell)
      if (complex->quality_of(id) < goal) smooth_node(*complex, *materials, n, goal + 0.05, surface);
  }
  template <class Operation>
  bool any_edge(const Cell& cell, Operation&& operation) const {
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (operation(cell[i], cell[j])) return true;
    return false;
  }
  bool change_topology(std::int32_t id) const {
    auto& c = *complex;
    const Cell cell = c.cell(id);
    if (any_edge(cell, [&](auto a, auto b) { return remove_edge(c, *materials, a, b, surface); })) return true;
    for (std::size_t corner = 0; corner < 4; ++corner)
      if (remove_face(c, id, corner)) return true;
    if (number >= contract_from && any_edge(cell, [&](auto a, auto b) {
          return collapse_edge(c, *materials, a, b, surface) || collapse_edge(c, *materials, b, a, surface);
        }))
      return true;
    return number >= divide_from &&
           any_edge(cell, [&](auto a, auto b) { return split_edge(c, *materials, a, b, goal + 0.05, surface); });
  }
  void smooth_region(std::int32_t id) const {
    constexpr int rounds = 3;
    constexpr double far_goal = 0.72;  // neighbours make room even where they are good enough
    const Cell cell = complex->cell(id);
    const auto nodes = nodes_around(*complex, cell);
    double before = -9;
    for (int round = 0; round < rounds && complex->quality_of(id) < goal; ++round) {
      if (complex->quality_of(id) <= before) break;
      before = complex->quality_of(id);
      for (const auto n : nodes) smooth_node(*complex, *materials, n, far_goal, surface);
      for (const auto n : cell) smooth_node(*complex, *materials, n, far_goal, surface);
    }
  }
};

// Moves the nodes around a bad cell at random, smooths them, and keeps what is better as a whole.
struct Shaker {
  const Sweep* sweep;
  std::vector<std::int32_t> nodes, cells;
  std::vector<Vec3> kept;

  Shaker(const Sweep& s, std::int32_t id) : sweep(&s), nodes(nodes_around(*s.complex, s.complex->cell(id))) {
    for (const auto n : nodes) {
      const auto star = s.complex->star(n);
      cells.insert(cells.end(), star.begin(), star.end());
    }
    sort_unique(cells);
    keep();
  }
  void keep() {
    kept.clear();
    for (const auto n : nodes) kept.push_back(sweep->complex->at(n));
  }
  void update() const { update_qualities(*sweep->complex, cells); }
  void go_back() const {
    for (std::size_t i = 0; i < nodes.size(); ++i)
      sweep->complex->nodes_mm[static_cast<std::size_t>(nodes[i])] = kept[i];
    update();
  }
  double penalty() const {
    double sum = 0;
    for (const auto t : cells) {
      const double lack = std::max(0.0, sweep->goal + 0.005 - sweep->complex->quality_of(t));
      sum += lack * lack;
    }
    return sum;
  }
  double worst() const { return worst_quality(*sweep->complex, cells); }
  void move_at_random(Noise& noise, double amplitude, const Cell* only) const {
    auto& c = *sweep->complex;
    for (const auto n : nodes) {
      if (c.is_frozen(n) || (only != nullptr && !has(*only, n))) continue;
      const double reach = amplitude * static_cast<double>(c.spacing_mm[static_cast<std::size_t>(n)]);
      const double x = noise.next(), y = noise.next(), z = noise.next();
      const Vec3 target = c.at(n) + reach * Vec3{x, y, z};
      const Vec3 place = is_constrained(c.bits(n)) ? project(*sweep->materials, c.bits(n), target, 3) : target;
      if (norm(place - c.at(n)) < 3 * reach) c.nodes_mm[static_cast<std::size_t>(n)] = place;
    }
    update();
  }
  void smooth_all() const {
    constexpr int rounds = 6;
    for (int round = 0; round < rounds; ++round)
      for (const auto n : nodes)
        smooth_node(*sweep->complex, *sweep->materials, n, sweep->goal + 0.02 * (rounds - round), sweep->surface);
  }
};

void shake(const Sweep& sweep, std::int32_t id, Noise& noise) {
  constexpr int tries = 8;
  Shaker shaker(sweep, id);
  const Cell cell = sweep.complex->cell(id);
  double penalty = shaker.penalty(), worst = shaker.worst();
  for (int i = 0; i < tries && penalty > 0; ++i) {
    shaker.move_at_random(noise, 0.08 + 0.03 * (i % 6), i % 2 == 0 ? &cell : nullptr);
    shaker.smooth_all();
    const double now = shaker.penalty();
    if (now < 0.999 * penalty && shaker.worst() >= worst) {
      penalty = now;
      worst = shaker.worst();
      shaker.keep();
    } else {
      shaker.go_back();
    }
  }
}

void smooth_all(const Sweep& sweep, const std::vector<std::int32_t>& bad) {
  constexpr std::size_t many = 2000;  // fewer in a slab are not worth a thread
  constexpr int cells_apart = 3;      // two bad ones whose corners share no cell with each other's
  const auto count = static_cast<std::int64_t>(bad.size());
  if (bad.size() < many || count > *sweep.budget) {
    for (const auto id : bad)
      if (sweep.may_try(id)) sweep.smooth_corners(id);
    return;
  }
  *sweep.budget -= count;
  const auto& c = *sweep.complex;
  for_slabs(
      slabs_across(c, cells_apart, bad.size() / many), bad.size(),
      [&](std::size_t i) { return c.at(c.cell(bad[i])[0]); },
      [&](std::size_t i) {
        if (sweep.is_bad(bad[i])) sweep.smooth_corners(bad[i]);
      });
}

void run(const Sweep& sweep, const std::vector<std::int32_t>& bad, const RepairSettings& settings, Noise& noise,
         int& shakes_left) {
  smooth_all(sweep, bad);
  for (const auto id : bad)
    if (sweep.may_try(id)) sweep.change_topology(id);
  if (sweep.number >= regional_from)
    for (const auto id : bad_cells(*sweep.complex, sweep.goal))
      if (sweep.may_try(id)) sweep.smooth_region(id);
  if (sweep.number < shake_from) return;
  if (settings.may_relabel && sweep.number % 2 == 1)
    for (const auto id : bad_cells(*sweep.complex, settings.least))
      if (sweep.complex->is_alive(id)) relabel_spike(*sweep.complex, id);
  for (const auto id : bad_cells(*sweep.complex, settings.least))
    if (sweep.complex->quality_of(id) < settings.least && shakes_left-- > 0 && sweep.may_try(id))
      shake(sweep, id, noise);
}

}  // namespace

std::int64_t repair(Complex& complex, const Materials& materials, const RepairSettings& settings) {
  constexpr int max_shakes = 1000, max_stalled = 3;
  Noise noise;
  int shakes_left = max_shakes, stalled = 0;
  std::int64_t budget = settings.budget;
  auto bad = bad_cells(complex, settings.goal);
  for (int number = 0; number < settings.sweeps && !bad.empty() && stalled < max_stalled && budget > 0; ++number) {
    const double loose = number < loosen_from ? 0 : std::min(1.0, 0.2 * (number - loosen_from + 1));
    const SurfaceTolerance surface{loose * settings.tolerance, settings.middle, settings.face};
    run({&complex, &materials, settings.goal, number, surface, &budget}, bad, settings, noise, shakes_left);
    const auto left = bad_cells(complex, settings.goal);
    stalled = left.size() < bad.size() || number < loosen_from ? 0 : stalled + 1;
    bad = left;
  }
  return static_cast<std::int64_t>(bad.size());
}

}  // namespace heartgen::tetmesh
