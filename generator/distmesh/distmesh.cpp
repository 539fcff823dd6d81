// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/distmesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/distmesh/bind.hpp"
#include "generator/distmesh/corners.hpp"
#include "generator/distmesh/start.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/feature.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::distmesh {
namespace {

constexpr int control_every = 10;       // iterations between rounds of adding and removing nodes
constexpr double control_until = 0.7;   // of the iterations: the rest only settles
constexpr double max_step = 0.25;       // of the edge, per iteration
constexpr double max_correction = 0.5;  // of the edge, back onto an interface
constexpr double max_offset = 0.05;     // of the edge, of a bound node from its interface
constexpr int newton_steps = 3;

struct Problem {
  const Materials* materials;
  Dimension dimension;
  const TrussSettings* settings;
};

/// Bars of the simplices inside, with the wanted length of each node.
struct Bars {
  std::vector<Edge> edges;
  std::vector<double> wanted;  // mean of materials.edge_mm at both ends
};

std::vector<std::uint8_t> labels_of(const Nodes& nodes, const Simplices& simplices, const Materials& materials) {
  std::vector<std::uint8_t> label(simplices.cells.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(label.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s)
      label[s] = static_cast<std::uint8_t>(label_of(nodes, simplices.cells[s], simplices.corners, materials));
  });
  return label;
}

void drop_simplices_outside(const Nodes& nodes, Simplices& simplices, const Materials& materials) {
  const auto label = labels_of(nodes, simplices, materials);
  std::size_t kept = 0;
  for (std::size_t s = 0; s < label.size(); ++s)
    if (label[s] != 0) simplices.cells[kept++] = simplices.cells[s];
  simplices.cells.resize(kept);
}

Bars bars_of(const Nodes& nodes, const Simplices& simplices, const Materials& materials) {
  Bars bars;
  bars.edges = edges_of(simplices, nodes.size());
  std::vector<double> edge(nodes.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(edge.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      edge[n] = materials.edge_mm(nodes.at_mm[n]);
  });
  bars.wanted.reserve(bars.edges.size());
  for (const auto& [a, b] : bars.edges)
    bars.wanted.push_back(0.5 * (edge[static_cast<std::size_t>(a)] + edge[static_cast<std::size_t>(b)]));
  return bars;
}

double length_of(const Nodes& nodes, const Edge& bar) {
  return norm(nodes.at_mm[static_cast<std::size_t>(bar[1])] - nodes.at_mm[static_cast<std::size_t>(bar[0])]);
}

/// Factor from wanted lengths to those that fill the truss: (sum L^d / sum wanted^d)^(1/d).
double fill_factor(const Nodes& nodes, const Bars& bars, Dimension dimension) {
  const int d = static_cast<int>(dimension);
  double lengths = 0, wanted = 0;
  for (std::size_t i = 0; i < bars.edges.size(); ++i) {
    const double l = length_of(nodes, bars.edges[i]), w = bars.wanted[i];
    lengths += d == 2 ? l * l : l * l * l;
    wanted += d == 2 ? w * w : w * w * w;
  }
  return math::pow(lengths / wanted, 1.0 / d);
}

std::vector<Vec3> forces_on(const Nodes& nodes, const Bars& bars, const Problem& problem) {
  const double factor = problem.settings->pressure * fill_factor(nodes, bars, problem.dimension);
  std::vector<Vec3> force(nodes.size());
  for (std::size_t i = 0; i < bars.edges.size(); ++i) {
    const auto a = static_cast<std::size_t>(bars.edges[i][0]), b = static_cast<std::size_t>(bars.edges[i][1]);
    const Vec3 along = nodes.at_mm[b] - nodes.at_mm[a];
    const double length = norm(along), push = factor * bars.wanted[i] - length;
    if (push <= 0 || length <= 0) continue;
    force[a] -= push / length * along;
    force[b] += push / length * along;
  }
  return force;
}

// Where a node that wants to be at `target` may go: bound nodes along their interface; free ones not out of the mesh.
Vec3 allowed_place(const Materials& materials, const Vec3& from, const Vec3& target, LabelBits touches, double edge) {
  if (std::popcount(touches) == 1) return is_outside(bits_at(materials, target)) ? from : target;
  const Vec3 place = tetmesh::project(materials, touches, target, newton_steps);
  const bool is_there = norm(place - target) <= max_correction * edge &&
                        tetmesh::distance_to(tetmesh::feature_at(materials, touches, place)) <= max_offset * edge;
  return is_there ? place : from;
}

/// Returns the greatest move of a node, in its edges.
double move_nodes(Nodes& nodes, const Bars& bars, const Problem& problem) {
  const auto force = forces_on(nodes, bars, problem);
  std::vector<float> moved(nodes.size(), 0);
  const auto move = [&](std::size_t n) {
    if (constraints(nodes.touches[n]) >= static_cast<int>(problem.dimension)) return;
    const double edge = problem.materials->edge_mm(nodes.at_mm[n]);
    Vec3 step = problem.settings->step * force[n];
    if (norm(step) > max_step * edge) step = max_step * edge * normalized(step);
    const Vec3 from = nodes.at_mm[n];
    nodes.at_mm[n] = allowed_place(*problem.materials, from, from + step, nodes.touches[n], edge);
    moved[n] = static_cast<float>(norm(nodes.at_mm[n] - from) / edge);
  };
  const auto first = static_cast<std::int64_t>(nodes.fixed), end = static_cast<std::int64_t>(nodes.size());
  parallel::parallel_for(first, end, [&](std::int64_t from, std::int64_t to) {
    for (auto n = from; n < to; ++n) move(static_cast<std::size_t>(n));
  });
  return static_cast<double>(*std::ranges::max_element(moved));
}

/// Share of the nodes that are farther than allowed from where they were when the bars were found.
double share_moved(const Nodes& nodes, const std::vector<Vec3>& connected_at, const Problem& problem) {
  std::size_t count = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Vec3 way = nodes.at_mm[n] - connected_at[n];
    const double allowed = problem.settings->retriangulate * problem.materials->edge_mm(nodes.at_mm[n]);
    count += dot(way, way) > allowed * allowed;
  }
  return static_cast<double>(count) / static_cast<double>(nodes.size());
}

/// A node in the middle of a bar: on the interface that both ends share, or free.
void add_middle(Nodes& nodes, const Edge& bar, const Problem& problem) {
  const auto a = static_cast<std::size_t>(bar[0]), b = static_cast<std::size_t>(bar[1]);
  const auto& m = *problem.materials;
  Vec3 middle = 0.5 * (nodes.at_mm[a] + nodes.at_mm[b]);
  LabelBits bits = nodes.touches[a] & nodes.touches[b];
  const double edge = m.edge_mm(middle);
  const auto is_interface = [&](const Vec3& p) {
    return (bits & ~bits_around(m, problem.dimension, p, 0.12 * edge)) == 0;
  };
  if (std::popcount(bits) > 1) {
    const Vec3 place = tetmesh::project(m, bits, middle, newton_steps);
    if (norm(place - middle) < max_correction * edge && is_interface(place))
      middle = place;
    else
      bits = 0;
  }
  if (std::popcount(bits) < 2) bits = bits_at(m, middle);
  if (is_outside(bits)) return;
  nodes.at_mm.push_back(middle);
  nodes.touches.push_back(bits);
}

void remove_marked(Nodes& nodes, const std::vector<std::uint8_t>& gone) {
  std::size_t kept = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (n < gone.size() && gone[n] == 2) continue;
    nodes.at_mm[kept] = nodes.at_mm[n];
    nodes.touches[kept++] = nodes.touches[n];
  }
  nodes.at_mm.resize(kept);
  nodes.touches.resize(kept);
}

/// Takes nodes from bars that are far too short and gives some to those far too long; neighbours of a changed bar wait
/// for the next round. Of two nodes the less bound one goes.
void control_density(Nodes& nodes, const Bars& bars, const Problem& problem) {
  const double factor = fill_factor(nodes, bars, problem.dimension);
  std::vector<std::uint8_t> used(nodes.size(), 0);  // 1: near a change, 2: removed
  for (std::size_t i = 0; i < bars.edges.size(); ++i) {
    const auto a = static_cast<std::size_t>(bars.edges[i][0]), b = static_cast<std::size_t>(bars.edges[i][1]);
    if (used[a] != 0 || used[b] != 0) continue;
    const double length = length_of(nodes, bars.edges[i]) / (std::min(factor, 1.0) * bars.wanted[i]);
    if (length > problem.settings->longest_bar) {
      add_middle(nodes, bars.edges[i], problem);
    } else if (length < problem.settings->shortest_bar) {
      const auto rank = [&](std::size_t n) { return n < nodes.fixed ? 9 : constraints(nodes.touches[n]); };
      const auto gone = rank(a) < rank(b) ? a : b;
      if (rank(gone) >= static_cast<int>(problem.dimension)) continue;
      used[a] = used[b] = 1;
      used[gone] = 2;
      continue;
    } else {
      continue;
    }
    used[a] = used[b] = 1;
  }
  used.resize(nodes.size(), 0);
  remove_marked(nodes, used);
}

/// Corners of the box and given nodes, which are fixed, and points that two or more interfaces hold.
Nodes first_nodes(const Problem& problem, double min_edge_mm) {
  constexpr double probe_reach = 0.12, max_samples = 4e6;
  const auto& m = *problem.materials;
  auto nodes = box_corners(m, problem.dimension);
  for (const auto& p : problem.settings->fixed_mm) {
    nodes.at_mm.push_back(p);
    nodes.touches.push_back(bits_around(m, problem.dimension, p, probe_reach * m.edge_mm(p)));
  }
  nodes.fixed = nodes.size();
  if (problem.dimension == Dimension::two) {
    const Vec3 size = m.box_max_mm - m.box_min_mm;
    add_meeting_points(nodes, m, std::max(0.5 * min_edge_mm, std::sqrt(size.x * size.y / max_samples)));
    add_side_nodes(nodes, m);
  }
  return nodes;
}

Bars connect_bars(Nodes& nodes, const Problem& problem) {
  auto simplices = delaunay(nodes, problem.dimension);
  resolve_crossings(nodes, simplices, *problem.materials, problem.dimension);
  drop_simplices_outside(nodes, simplices, *problem.materials);
  bind_hull(nodes, simplices, *problem.materials, problem.dimension);
  return bars_of(nodes, simplices, *problem.materials);
}

/// Takes the less bound end of every bar shorter than `least` wanted lengths.
void thin_out(Nodes& nodes, const Bars& bars, Dimension dimension, double least) {
  std::vector<std::uint8_t> used(nodes.size(), 0);
  for (std::size_t i = 0; i < bars.edges.size(); ++i) {
    const auto a = static_cast<std::size_t>(bars.edges[i][0]), b = static_cast<std::size_t>(bars.edges[i][1]);
    if (used[a] == 2 || used[b] == 2 || length_of(nodes, bars.edges[i]) >= least * bars.wanted[i]) continue;
    const auto rank = [&](std::size_t n) { return n < nodes.fixed ? 9 : constraints(nodes.touches[n]); };
    const auto gone = rank(a) < rank(b) ? a : b;
    if (rank(gone) < static_cast<int>(dimension)) used[gone] = 2;
  }
  remove_marked(nodes, used);
}

/// Triangulates until no edge crosses an interface, or nothing helps any more.
void finish(Truss& truss, const Problem& problem) {
  constexpr int max_rounds = 8, thinning_rounds = 2, max_stalled = 3;
  constexpr double crowded = 0.4;
  auto& nodes = truss.nodes;
  const auto& m = *problem.materials;
  auto fewest = std::numeric_limits<std::int64_t>::max();
  for (int round = 0, stalled = 0; round < max_rounds && stalled < max_stalled; ++round) {
    truss.simplices = delaunay(nodes, problem.dimension);
    truss.crossing = resolve_crossings(nodes, truss.simplices, m, problem.dimension);
    drop_simplices_outside(nodes, truss.simplices, m);
    const auto bound = std::ranges::count_if(nodes.touches, tetmesh::is_constrained);
    bind_hull(nodes, truss.simplices, m, problem.dimension);
    if (truss.crossing == 0 && bound == std::ranges::count_if(nodes.touches, tetmesh::is_constrained)) break;
    stalled = truss.crossing < fewest ? 0 : stalled + 1;
    fewest = std::min(fewest, truss.crossing);
    const auto bars = bars_of(nodes, truss.simplices, m);
    if (truss.crossing > 0) divide_crossings(nodes, truss.simplices, m, problem.dimension);
    if (round < thinning_rounds) thin_out(nodes, bars, problem.dimension, crowded);
  }
  drop_outside(nodes);
  truss.simplices = delaunay(nodes, problem.dimension);
  truss.label = labels_of(nodes, truss.simplices, m);
  absorb_crumbs(truss.simplices, truss.label);
}

}  // namespace

TrussSettings default_settings(Dimension dimension) {
  TrussSettings settings;
  if (dimension == Dimension::three) {
    settings.pressure = 1.1;
    settings.iterations = 30;
    settings.moved_share = 0.05;
  }
  return settings;
}

Truss relax(Nodes start, const Materials& materials, Dimension dimension, const TrussSettings& settings) {
  const Problem problem{&materials, dimension, &settings};
  Truss truss;
  auto& nodes = truss.nodes = std::move(start);
  if (nodes.size() < static_cast<std::size_t>(dimension) + 1)
    throw UserError("no part of the domain is as large as an edge", "mesh", "give a smaller edge length");
  auto bars = connect_bars(nodes, problem);
  drop_outside(nodes);
  bars = connect_bars(nodes, problem);
  auto connected_at = nodes.at_mm;
  for (int i = 1; i <= settings.iterations; ++i) {
    truss.iterations = i;
    if (settings.on_tenth && 10 * i / settings.iterations != 10 * (i - 1) / settings.iterations) settings.on_tenth();
    if (move_nodes(nodes, bars, problem) < settings.still) break;
    const bool controls = i % control_every == 0 && i < control_until * settings.iterations;
    if (!controls && share_moved(nodes, connected_at, problem) < settings.moved_share) continue;
    if (controls) control_density(nodes, bars, problem);
    rebind(nodes, materials, dimension);
    drop_outside(nodes);
    bars = connect_bars(nodes, problem);
    connected_at = nodes.at_mm;
  }
  finish(truss, problem);
  return truss;
}

Truss relax(const Materials& materials, Dimension dimension, double min_edge_mm, const TrussSettings& settings) {
  auto nodes = first_nodes({&materials, dimension, &settings}, min_edge_mm);
  add_start_nodes(nodes, materials, dimension, min_edge_mm);
  return relax(std::move(nodes), materials, dimension, settings);
}

}  // namespace heartgen::distmesh
