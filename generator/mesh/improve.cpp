// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/improve.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "generator/mesh/flips.hpp"
#include "generator/mesh/quality.hpp"
#include "generator/mesh/surfaces.hpp"
#include "generator/parallel/gather.hpp"
#include "model/mathematics.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::mesh {
namespace {

using Corners = std::array<Vec3, 4>;

enum class Freedom : std::uint8_t { fixed, curve, surface, inside };

struct Workspace {
  std::vector<Vec3>* nodes;
  std::span<const Cell> cells;
  std::vector<std::int32_t> first, star;  // kept cells around each node
  std::vector<Freedom> freedom;
  std::vector<Vec3> normal;  // of surface nodes

  std::span<const std::int32_t> around(std::int32_t node) const {
    const auto n = static_cast<std::size_t>(node);
    return {star.data() + first[n], static_cast<std::size_t>(first[n + 1] - first[n])};
  }
  Corners corners(std::int32_t cell) const {
    Corners p;
    for (std::size_t i = 0; i < 4; ++i)
      p[i] = (*nodes)[static_cast<std::size_t>(cells[static_cast<std::size_t>(cell)][i])];
    return p;
  }
};

// How many labels meet in each node, and the mean normal of the faces between two labels there.
void classify(Workspace& w, std::span<const std::int32_t> label, std::int32_t first_dropped) {
  constexpr std::int32_t none = -1, many = -2;
  const std::size_t count = w.nodes->size();
  std::vector<std::array<std::int32_t, 2>> met(count, {none, none});
  std::vector<bool> at_end(count, false);  // of the cells, or of a surface that is cut where dropped cells begin
  for (std::size_t c = 0; c < w.cells.size(); ++c)
    for (const auto n : w.cells[c]) {
      auto& m = met[static_cast<std::size_t>(n)];
      if (label[c] >= first_dropped) at_end[static_cast<std::size_t>(n)] = true;
      if (m[0] == none)
        m[0] = label[c];
      else if (m[0] != label[c] && m[1] == none)
        m[1] = label[c];
      else if (m[0] != label[c] && m[1] != label[c])
        m[1] = many;
    }
  w.normal.assign(count, {});
  std::vector<bool> on_hull(count, false);
  for (const auto& face : cell_faces(std::vector<Cell>(w.cells.begin(), w.cells.end()))) {
    const auto label_of = [&](std::int32_t cell) { return label[static_cast<std::size_t>(cell)]; };
    if (face.other >= 0 && label_of(face.cell) == label_of(face.other)) continue;
    const auto p = [&](std::size_t i) { return (*w.nodes)[static_cast<std::size_t>(face.nodes[i])]; };
    Vec3 area = cross(p(1) - p(0), p(2) - p(0));
    if (face.other >= 0 && label_of(face.cell) > label_of(face.other)) area = -area;
    for (const auto n : face.nodes) {
      w.normal[static_cast<std::size_t>(n)] += area;
      if (face.other < 0) on_hull[static_cast<std::size_t>(n)] = true;
    }
  }
  w.freedom.assign(count, Freedom::fixed);
  for (std::size_t n = 0; n < count; ++n) {
    w.normal[n] = normalized(w.normal[n]);
    if (on_hull[n] || (at_end[n] && met[n][1] == many)) continue;
    w.freedom[n] = met[n][1] == none ? Freedom::inside : met[n][1] == many ? Freedom::curve : Freedom::surface;
  }
}

Workspace prepare(std::vector<Vec3>& nodes, std::span<const Cell> cells, std::span<const std::int32_t> label,
                  std::int32_t first_dropped) {
  Workspace w{&nodes, cells, {}, {}, {}, {}};
  classify(w, label, first_dropped);
  w.first.assign(nodes.size() + 1, 0);
  const auto kept = [&](std::size_t c) { return label[c] > 0 && label[c] < first_dropped; };
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (kept(c))
      for (const auto n : cells[c]) ++w.first[static_cast<std::size_t>(n) + 1];
  for (std::size_t n = 0; n < nodes.size(); ++n) w.first[n + 1] += w.first[n];
  w.star.resize(static_cast<std::size_t>(w.first.back()));
  auto next = w.first;
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (kept(c))
      for (const auto n : cells[c])
        w.star[static_cast<std::size_t>(next[static_cast<std::size_t>(n)]++)] = static_cast<std::int32_t>(c);
  return w;
}

/// The cells around one node, with the node's place among their corners.
struct Star {
  std::vector<Corners> cells;
  std::vector<std::size_t> place;
  double shortest_mm = std::numeric_limits<double>::max();

  double worst(const Vec3& position, double stop_below) const {
    double least = std::numeric_limits<double>::max();
    for (std::size_t c = 0; c < cells.size() && least > stop_below; ++c) least = std::min(least, at(c, position));
    return least;
  }
  double at(std::size_t c, const Vec3& position) const {
    auto p = cells[c];
    p[place[c]] = position;
    return min_sine(p);
  }
};

Star star_of(const Workspace& w, std::int32_t node) {
  Star star;
  for (const auto cell : w.around(node)) {
    const auto& ids = w.cells[static_cast<std::size_t>(cell)];
    star.cells.push_back(w.corners(cell));
    star.place.push_back(static_cast<std::size_t>(std::find(ids.begin(), ids.end(), node) - ids.begin()));
    const auto& p = star.cells.back();
    for (std::size_t i = 0; i < 4; ++i)
      if (i != star.place.back()) star.shortest_mm = std::min(star.shortest_mm, norm(p[i] - p[star.place.back()]));
  }
  return star;
}

// Direction in which the worst cell around the node gets better: its quality's gradient by central differences.
Vec3 ascent(const Star& star, const Vec3& position) {
  std::size_t worst = 0;
  for (std::size_t c = 1; c < star.cells.size(); ++c)
    if (star.at(c, position) < star.at(worst, position)) worst = c;
  const double step = 1e-4 * star.shortest_mm;
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 up = position, down = position;
    up[axis] += step;
    down[axis] -= step;
    gradient[axis] = star.at(worst, up) - star.at(worst, down);
  }
  return normalized(gradient);
}

Vec3 middle_of(const Star& star) {
  Vec3 sum;
  for (std::size_t c = 0; c < star.cells.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i)
      if (i != star.place[c]) sum += star.cells[c][i];
  return sum / (3.0 * static_cast<double>(star.cells.size()));
}

// Moves one node to the best place found on two lines: uphill for its worst cell, and towards its neighbours' middle.
bool improve_node(const Workspace& w, std::int32_t node, const ImproveSettings& settings) {
  const auto n = static_cast<std::size_t>(node);
  if (w.freedom[n] == Freedom::fixed) return false;
  const auto star = star_of(w, node);
  if (star.cells.empty()) return false;
  const auto freedom = w.freedom[n];
  const double reach = freedom == Freedom::inside    ? 0.5
                       : freedom == Freedom::surface ? settings.surface_drift
                                                     : settings.curve_drift;
  const auto allowed = [&](Vec3 move) {
    if (freedom == Freedom::surface) move = move - dot(move, w.normal[n]) * w.normal[n];
    const double most = reach * star.shortest_mm;
    const double length = norm(move);
    return length > most ? (most / length) * move : move;
  };
  Vec3& position = (*w.nodes)[n];
  double best = star.worst(position, -1);
  bool moved = false;
  for (int attempt = 0; attempt < 3; ++attempt) {
    const Vec3 start = position;
    const double before = best;
    for (const Vec3& direction : {allowed(star.shortest_mm * ascent(star, start)), allowed(middle_of(star) - start)})
      for (const double share : {1.0, 0.5, 0.25, 0.125, 0.0625}) {
        const Vec3 candidate = start + share * direction;
        const double value = star.worst(candidate, best);
        if (value <= best + 1e-9) continue;
        best = value;
        position = candidate;
      }
    if (best <= before) break;
    moved = true;
    if (freedom != Freedom::inside) break;  // its drift per round is bounded
  }
  return moved;
}

double sine_of(double angle_deg) { return math::sin(angle_deg * std::numbers::pi / 180); }

void move_bad_vertices(std::vector<Vec3>& nodes_mm, std::span<const Cell> cells, std::span<const std::int32_t> label,
                       std::int32_t first_dropped_label, const ImproveSettings& settings) {
  const auto w = prepare(nodes_mm, cells, label, first_dropped_label);
  const double goal = sine_of(settings.goal_deg);
  for (int round = 0; round < settings.rounds; ++round) {
    std::vector<std::int32_t> nodes;
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (label[c] > 0 && label[c] < first_dropped_label && min_sine(w.corners(static_cast<std::int32_t>(c))) < goal)
        nodes.insert(nodes.end(), cells[c].begin(), cells[c].end());
    sort_unique(nodes);
    bool moved = false;
    for (const auto node : nodes) moved |= improve_node(w, node, settings);
    if (!moved) break;
  }
}

}  // namespace

void improve(std::vector<Vec3>& nodes_mm, std::vector<Cell>& cells, std::vector<std::int32_t>& label,
             std::int32_t first_dropped_label, const ImproveSettings& settings) {
  for (int pass = 0; pass < settings.passes; ++pass) {
    flip_bad_cells(nodes_mm, cells, label, first_dropped_label, sine_of(settings.goal_deg));
    move_bad_vertices(nodes_mm, cells, label, first_dropped_label, settings);
  }
  sort_cells(nodes_mm, cells, label);
}

void sort_cells(const std::vector<Vec3>& nodes_mm, std::vector<Cell>& cells, std::vector<std::int32_t>& label) {
  using Labelled = std::pair<Cell, std::int32_t>;
  parallel::parallel_for(0, static_cast<std::int64_t>(cells.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
      Cell& cell = cells[c];
      std::sort(cell.begin(), cell.end());
      const auto p = [&](std::size_t i) { return nodes_mm[static_cast<std::size_t>(cell[i])]; };
      if (dot(p(1) - p(0), cross(p(2) - p(0), p(3) - p(0))) < 0) std::swap(cell[2], cell[3]);
    }
  });
  // Few cells have the same first node: in its place, each node's cells are sorted by themselves.
  const auto of_nodes = [&](std::int64_t first, std::int64_t last, std::vector<Labelled>& sorted) {
    std::vector<std::size_t> end(static_cast<std::size_t>(last - first) + 1, 0);
    const auto each = [&](const auto& visit) {
      for (std::size_t c = 0; c < cells.size(); ++c)
        if (const auto node = cells[c][0]; node >= first && node < last)
          visit(static_cast<std::size_t>(node - first), c);
    };
    each([&](std::size_t node, std::size_t) { ++end[node + 1]; });
    std::partial_sum(end.begin(), end.end(), end.begin());
    sorted.resize(end.back());
    each([&](std::size_t node, std::size_t c) { sorted[end[node]++] = {cells[c], label[c]}; });
    auto begin = sorted.begin();
    for (std::size_t node = 0; node + 1 < end.size(); ++node) {
      const auto stop = sorted.begin() + static_cast<std::ptrdiff_t>(end[node]);
      std::sort(begin, stop);
      begin = stop;
    }
  };
  const auto sorted = parallel::gather<Labelled>(0, static_cast<std::int64_t>(nodes_mm.size()), of_nodes);
  for (std::size_t c = 0; c < cells.size(); ++c) std::tie(cells[c], label[c]) = sorted[c];
}

}  // namespace heartgen::mesh
