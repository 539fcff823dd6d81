// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/bind.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/feature.hpp"

namespace heartgen::distmesh {
namespace {

// All in wanted edges.
constexpr double probe_reach = 0.12;    // what meets at a place is looked for so far around it
constexpr double max_correction = 0.4;  // from where an edge or triangle crosses to the feature
constexpr double max_move = 0.75;       // of a node onto a feature
constexpr double apart = 0.4;           // between two nodes on the same corner
constexpr int newton_steps = 5;

LabelBits lowest(LabelBits bits) { return bits & (~bits + 1); }

struct Setting {
  const Materials* materials;
  Dimension dimension;
  double edge_at(const Vec3& p) const { return materials->edge_mm(p); }
};

/// Where an edge leaves what its first end touches, as a share of its length, and what lies beyond.
struct Exit {
  double share = 1;
  LabelBits beyond = 0;
};

Exit find_exit(const Materials& materials, const Vec3& from, const Vec3& to, LabelBits touches) {
  constexpr int samples = 8, halvings = 12;
  const auto at = [&](double t) { return bits_at(materials, from + t * (to - from)); };
  for (int i = 1; i <= samples; ++i) {
    double outside = static_cast<double>(i) / samples, inside = outside - 1.0 / samples;
    LabelBits beyond = at(outside);
    if ((beyond & touches) != 0) continue;
    for (int h = 0; h < halvings; ++h) {
      const double middle = 0.5 * (inside + outside);
      const LabelBits found = at(middle);
      if ((found & touches) != 0) {
        inside = middle;
      } else {
        outside = middle;
        beyond = found;
      }
    }
    return {outside, beyond};
  }
  return {};
}

/// The place of the feature `bits` within `reach` edges of `start`, if all of them meet there.
std::optional<Vec3> place_on(const Setting& s, LabelBits bits, const Vec3& start, double reach = max_correction) {
  if (constraints(bits) > static_cast<int>(s.dimension)) return {};
  const double edge = s.edge_at(start);
  const Vec3 place = tetmesh::project(*s.materials, bits, start, newton_steps);
  if (!(norm(place - start) <= reach * edge)) return {};
  const auto found = bits_around(*s.materials, s.dimension, place, probe_reach * edge);
  return (bits & ~found) == 0 ? std::optional(place) : std::nullopt;
}

struct Candidate {
  double distance;  // from the node to its new place, in edges
  std::int32_t node, other;
  LabelBits bits;
  Vec3 place;
};

void add_candidate(std::vector<Candidate>& list, const Setting& s, const Nodes& nodes, std::int32_t node,
                   std::int32_t other) {
  constexpr double max_share = 0.55;
  const auto n = static_cast<std::size_t>(node);
  if (n < nodes.fixed) return;
  const Vec3& from = nodes.at_mm[n];
  const Vec3& to = nodes.at_mm[static_cast<std::size_t>(other)];
  const auto exit = find_exit(*s.materials, from, to, nodes.touches[n]);
  if (exit.beyond == 0 || exit.share > max_share) return;
  const Vec3 crossing = from + exit.share * (to - from);
  const double distance = norm(crossing - from) / s.edge_at(crossing);
  if (distance <= max_move) list.push_back({distance, node, other, nodes.touches[n] | exit.beyond, crossing});
}

/// An edge crosses when its ends share no label. A side of the box is no label: what lies beyond it is outside.
bool crosses(const Nodes& nodes, const Edge& edge) {
  const auto a = nodes.touches[static_cast<std::size_t>(edge[0])], b = nodes.touches[static_cast<std::size_t>(edge[1])];
  return (a & b) == 0 && !(is_outside(a) && is_outside(b));
}

void bind_to_interfaces(Nodes& nodes, const std::vector<Edge>& edges, const Setting& s,
                        std::vector<std::uint8_t>& moved) {
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Candidate>& found) {
    for (auto e = begin; e < end; ++e) {
      const auto& edge = edges[static_cast<std::size_t>(e)];
      if (!crosses(nodes, edge)) continue;
      add_candidate(found, s, nodes, edge[0], edge[1]);
      add_candidate(found, s, nodes, edge[1], edge[0]);
    }
  };
  auto candidates = parallel::gather<Candidate>(0, static_cast<std::int64_t>(edges.size()), find);
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.distance, a.node, a.other) < std::tie(b.distance, b.node, b.other);
  });
  for (const auto& c : candidates) {
    const auto n = static_cast<std::size_t>(c.node), m = static_cast<std::size_t>(c.other);
    if (moved[n] != 0 || (moved[m] != 0 && (nodes.touches[n] & nodes.touches[m]) != 0)) continue;
    const auto place = place_on(s, c.bits, c.place);
    if (!place) continue;
    nodes.at_mm[n] = *place;
    nodes.touches[n] = c.bits;
    moved[n] = 1;
  }
}

// Labels inside a triangle: at the middles of its sides, in its centre, and half way from there to its corners.
LabelBits bits_inside(const Materials& materials, const std::array<Vec3, 3>& p) {
  const Vec3 center = (p[0] + p[1] + p[2]) / 3;
  LabelBits found = bits_at(materials, center);
  for (std::size_t i = 0; i < 3; ++i)
    found |= bits_at(materials, 0.5 * (p[i] + center)) | bits_at(materials, 0.5 * (p[i] + p[(i + 1) % 3]));
  return found;
}

bool is_taken(const Nodes& nodes, const Cell& triangle, LabelBits bits) {
  return std::any_of(triangle.begin(), triangle.begin() + 3,
                     [&](std::int32_t n) { return (bits & ~nodes.touches[static_cast<std::size_t>(n)]) == 0; });
}

void bind_in_triangle(Nodes& nodes, const Cell& triangle, const Setting& s, std::vector<std::uint8_t>& moved,
                      std::vector<std::pair<LabelBits, Vec3>>& corners) {
  std::array<Vec3, 3> p;
  LabelBits all = 0, common = ~LabelBits{0};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto n = static_cast<std::size_t>(triangle[i]);
    p[i] = nodes.at_mm[n];
    all |= nodes.touches[n];
    common &= nodes.touches[n];
  }
  if (common != 0 || std::popcount(all) < 3 || is_outside(all)) return;
  const LabelBits bits = bits_inside(*s.materials, p) & all;
  if (std::popcount(bits) < 3 || is_taken(nodes, triangle, bits)) return;
  const Vec3 center = (p[0] + p[1] + p[2]) / 3;
  const auto place = place_on(s, bits, center);
  if (!place) return;
  const double edge = s.edge_at(*place);
  if (constraints(bits) == static_cast<int>(s.dimension))  // a point of the domain takes one node
    for (const auto& [taken, where] : corners)
      if (taken == bits && norm(where - *place) < apart * edge) return;
  std::size_t nearest = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto n = static_cast<std::size_t>(triangle[i]);
    if (n < nodes.fixed || moved[n] != 0 || norm(p[i] - *place) > max_move * edge) continue;
    if (constraints(nodes.touches[n]) == static_cast<int>(s.dimension)) continue;
    if (nearest == 3 || norm(p[i] - *place) < norm(p[nearest] - *place)) nearest = i;
  }
  if (nearest == 3) return;
  const auto n = static_cast<std::size_t>(triangle[nearest]);
  nodes.at_mm[n] = *place;
  nodes.touches[n] = bits;
  moved[n] = 1;
  if (constraints(bits) == static_cast<int>(s.dimension)) corners.emplace_back(bits, *place);
}

void bind_to_curves(Nodes& nodes, const Simplices& simplices, const Setting& s, std::vector<std::uint8_t>& moved) {
  std::vector<std::pair<LabelBits, Vec3>> corners;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (constraints(nodes.touches[n]) >= static_cast<int>(s.dimension))
      corners.emplace_back(nodes.touches[n], nodes.at_mm[n]);
  for (const auto& cell : simplices.cells)
    for (std::size_t left_out = simplices.corners == 4 ? 0 : 3; left_out < 4; ++left_out) {
      Cell triangle{-1, -1, -1, -1};
      for (std::size_t i = 0, k = 0; i < 4; ++i)
        if (i != left_out) triangle[k++] = cell[i];
      bind_in_triangle(nodes, triangle, s, moved, corners);
    }
}

constexpr LabelBits hull_bits = bit_of(0) | tetmesh::side_bits;

/// The side of the box within `reach_mm`, or none.
LabelBits near_side(const Materials& materials, const Vec3& p, double reach_mm) {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] - materials.box_min_mm[axis] < reach_mm) return bit_of(tetmesh::first_side + 2 * axis);
    if (materials.box_max_mm[axis] - p[axis] < reach_mm) return bit_of(tetmesh::first_side + 2 * axis + 1);
  }
  return 0;
}

/// A node at the end of the mesh that touches nothing beyond goes to what is near.
void bind_to_hull(Nodes& nodes, std::int32_t node, const Setting& s) {
  const auto n = static_cast<std::size_t>(node);
  if (n < nodes.fixed || (nodes.touches[n] & hull_bits) != 0) return;
  const Vec3 from = nodes.at_mm[n];
  for (const auto beyond : {near_side(*s.materials, from, max_move * s.edge_at(from)), bit_of(0)}) {
    const LabelBits bits = nodes.touches[n] | beyond;
    const auto place = beyond == 0 ? std::nullopt : place_on(s, bits, from, max_move);
    if (!place) continue;
    nodes.at_mm[n] = *place;
    nodes.touches[n] = bits;
    return;
  }
}

/// Two nodes of the hull that do not lie on the same part of it (two sides of the box, a side and the outer surface):
/// the one nearer to where the parts meet goes there.
void bind_to_hull_edge(Nodes& nodes, std::int32_t a, std::int32_t b, const Setting& s) {
  const auto beyond = [&](std::int32_t n) { return nodes.touches[static_cast<std::size_t>(n)] & hull_bits; };
  if (beyond(a) == 0 || beyond(b) == 0 || (beyond(a) & beyond(b)) != 0) return;
  std::size_t nearest = nodes.size();
  LabelBits bits = 0;
  Vec3 place;
  for (const auto& [node, other] : {std::pair{a, b}, std::pair{b, a}}) {
    const auto n = static_cast<std::size_t>(node);
    if (n < nodes.fixed) continue;
    const LabelBits both = nodes.touches[n] | lowest(beyond(other));
    const auto found = place_on(s, both, nodes.at_mm[n], max_move);
    if (!found || (nearest < nodes.size() && norm(*found - nodes.at_mm[n]) >= norm(place - nodes.at_mm[nearest])))
      continue;
    nearest = n;
    bits = both;
    place = *found;
  }
  if (nearest == nodes.size()) return;
  nodes.at_mm[nearest] = place;
  nodes.touches[nearest] = bits;
}

}  // namespace

std::int64_t resolve_crossings(Nodes& nodes, const Simplices& simplices, const Materials& materials,
                               Dimension dimension) {
  const Setting setting{&materials, dimension};
  std::vector<std::uint8_t> moved(nodes.size(), 0);
  bind_to_curves(nodes, simplices, setting, moved);
  const auto edges = edges_of(simplices, nodes.size());
  bind_to_interfaces(nodes, edges, setting, moved);
  return std::count_if(edges.begin(), edges.end(), [&](const Edge& edge) { return crosses(nodes, edge); });
}

std::int64_t divide_crossings(Nodes& nodes, const Simplices& simplices, const Materials& materials,
                              Dimension dimension) {
  constexpr double nearest = 0.25;  // to an end, of the edge
  const Setting setting{&materials, dimension};
  std::vector<std::uint8_t> used(nodes.size(), 0);
  std::int64_t count = 0;
  for (const auto& edge : edges_of(simplices, nodes.size())) {
    const auto a = static_cast<std::size_t>(edge[0]), b = static_cast<std::size_t>(edge[1]);
    if (used[a] != 0 || used[b] != 0 || !crosses(nodes, edge)) continue;
    const auto exit = find_exit(materials, nodes.at_mm[a], nodes.at_mm[b], nodes.touches[a]);
    if (exit.beyond == 0 || exit.share < nearest || exit.share > 1 - nearest) continue;
    const Vec3 crossing = nodes.at_mm[a] + exit.share * (nodes.at_mm[b] - nodes.at_mm[a]);
    const Vec3 before = nodes.at_mm[a] + (exit.share - 0.01) * (nodes.at_mm[b] - nodes.at_mm[a]);
    const LabelBits bits = bits_at(materials, before) | exit.beyond;
    const auto place = place_on(setting, bits, crossing);
    if (!place) continue;
    nodes.at_mm.push_back(*place);
    nodes.touches.push_back(bits);
    used[a] = used[b] = 1;
    ++count;
  }
  return count;
}

void rebind(Nodes& nodes, const Materials& materials, Dimension dimension) {
  const Setting setting{&materials, dimension};
  const auto bits_of = [&](std::size_t n) {
    const LabelBits bits = nodes.touches[n];
    const Vec3& place = nodes.at_mm[n];
    if (nodes.is_free(n)) return bits_at(materials, place);
    const auto found = bits_around(materials, dimension, place, probe_reach * setting.edge_at(place));
    if ((bits & ~found) == 0) return bits;
    const LabelBits sides = bits & tetmesh::side_bits;
    LabelBits labels = found & ~tetmesh::side_bits;
    if (constraints(labels | sides) > static_cast<int>(dimension)) labels = lowest(labels);
    return labels | sides;
  };
  const auto first = static_cast<std::int64_t>(nodes.fixed), last = static_cast<std::int64_t>(nodes.size());
  parallel::parallel_for(first, last, [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
      nodes.touches[n] = bits_of(n);
  });
}

void bind_hull(Nodes& nodes, const Simplices& inside, const Materials& materials, Dimension dimension) {
  const Setting setting{&materials, dimension};
  const auto hull = hull_faces(inside);
  std::vector<std::uint8_t> is_done(nodes.size(), 0);
  for (const auto& face : hull)
    for (const auto n : face)
      if (n >= 0 && std::exchange(is_done[static_cast<std::size_t>(n)], 1) == 0) bind_to_hull(nodes, n, setting);
  for (const auto& face : hull)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = face[i], b = face[(i + 1) % 3];
      if (a >= 0 && b >= 0) bind_to_hull_edge(nodes, a, b, setting);
    }
}

void drop_outside(Nodes& nodes) {
  std::size_t kept = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (n >= nodes.fixed && is_outside(nodes.touches[n])) continue;
    nodes.at_mm[kept] = nodes.at_mm[n];
    nodes.touches[kept++] = nodes.touches[n];
  }
  nodes.at_mm.resize(kept);
  nodes.touches.resize(kept);
}

}  // namespace heartgen::distmesh
