// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/improve_triangles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "generator/tetmesh/feature.hpp"
#include "model/mathematics.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::distmesh {
namespace {

// When each operation joins in: cheap and harmless ones first.
constexpr int divide_from = 1, cut_tips_from = 2, loosen_from = 3, shake_from = 5;
constexpr double max_deviation = 0.12;  // of a new interface edge's middle, in its length

/// What an attempted change did, to take it back.
struct Journal {
  std::vector<std::pair<std::int32_t, Vec3>> places;  ///< before
  std::vector<std::pair<std::int32_t, LabelBits>> touches;
  std::vector<std::int32_t> added;
  std::vector<std::pair<std::int32_t, Face>> removed;
};

struct Score {
  double worst = 9;
  double penalty = 0;  ///< sum of the squares of what lacks
};

struct Improver {
  Triangles& mesh;
  const Materials& materials;
  double goal;           // sine
  double tolerance = 0;  // of the present sweep
  double tip;
  Journal journal{};

  double edge_at(std::int32_t n) const { return materials.edge_mm(mesh.at(n)); }
  const std::vector<std::int32_t>& star(std::int32_t n) const { return mesh.star[static_cast<std::size_t>(n)]; }
  bool is_bad(std::int32_t t) const { return mesh.is_alive(t) && quality(mesh, t) < goal; }

  // Changes, noted in the journal.
  void place(std::int32_t n, const Vec3& p) {
    journal.places.emplace_back(n, mesh.at(n));
    mesh.nodes_mm[static_cast<std::size_t>(n)] = p;
  }
  void touch(std::int32_t n, LabelBits bits) {
    journal.touches.emplace_back(n, mesh.bits(n));
    mesh.touches[static_cast<std::size_t>(n)] = bits;
  }
  void add(const Face& corners, int label) { journal.added.push_back(add_triangle(mesh, corners, label)); }
  void remove(std::int32_t t) {
    journal.removed.emplace_back(t, mesh.triangle(t));
    remove_triangle(mesh, t);
  }
  void undo() {
    for (const auto t : journal.added) remove_triangle(mesh, t);
    for (const auto& [t, corners] : journal.removed) restore_triangle(mesh, t, corners);
    for (auto it = journal.touches.rbegin(); it != journal.touches.rend(); ++it)
      mesh.touches[static_cast<std::size_t>(it->first)] = it->second;
    for (auto it = journal.places.rbegin(); it != journal.places.rend(); ++it)
      mesh.nodes_mm[static_cast<std::size_t>(it->first)] = it->second;
  }

  double worst_around(std::int32_t n) const {
    double worst = 9;
    for (const auto t : star(n)) worst = std::min(worst, quality(mesh, t));
    return worst;
  }
  Score score_of(const std::vector<std::int32_t>& nodes) const {
    std::vector<std::int32_t> triangles;
    for (const auto n : nodes) triangles.insert(triangles.end(), star(n).begin(), star(n).end());
    sort_unique(triangles);
    Score score;
    for (const auto t : triangles) {
      const double q = quality(mesh, t), lack = std::max(0.0, goal + 0.002 - q);
      score.worst = std::min(score.worst, q);
      score.penalty += lack * lack;
    }
    return score;
  }

  // Directions in which a node may go at all: none, along a side of the box, everywhere.
  bool may_move(std::int32_t n) const {
    if (mesh.pinned[static_cast<std::size_t>(n)] != 0) return false;
    const LabelBits bits = mesh.bits(n);
    return constraints(bits) < 2 || (tolerance > 0 && std::popcount(bits & tetmesh::side_bits) < 2);
  }
  // The place for a node that wants to be at `target`; false where it may not go there.
  bool settle(std::int32_t n, Vec3& target) const {
    const LabelBits bits = mesh.bits(n);
    if (!tetmesh::is_constrained(bits)) return true;
    const double edge = edge_at(n);
    if (tolerance == 0) {
      const Vec3 wanted = target;
      target = tetmesh::project(materials, bits, wanted, 3);
      return norm(target - wanted) < 0.5 * edge;
    }
    for (int side = 0; side < 4; ++side)
      if ((bits & bit_of(tetmesh::first_side + side)) != 0)
        target[side / 2] = (side % 2 == 0 ? materials.box_min_mm : materials.box_max_mm)[side / 2];
    const double allowed =
        std::max(tolerance * edge, tetmesh::distance_to(tetmesh::feature_at(materials, bits, mesh.at(n))));
    return tetmesh::distance_to(tetmesh::feature_at(materials, bits, target)) <= allowed;
  }
  // Pattern search for the place with the best worst triangle.
  void smooth(std::int32_t n, double enough) {
    constexpr int directions = 8;
    if (!may_move(n)) return;
    double best = worst_around(n);
    if (best >= enough) return;
    const Vec3 start = mesh.at(n);
    Vec3 kept = start;
    auto& now = mesh.nodes_mm[static_cast<std::size_t>(n)];
    double reach = 0.2 * edge_at(n);
    for (int halving = 0; halving < 5; ++halving, reach *= 0.5) {
      Vec3 center = kept;
      for (int i = 0; i < directions; ++i) {
        const double angle = 2 * std::numbers::pi * i / directions;
        Vec3 target = center + reach * Vec3{math::cos(angle), math::sin(angle), 0};
        now = center;
        if (!settle(n, target)) continue;
        now = target;
        const double worst = worst_around(n);
        if (worst <= best) continue;
        best = worst;
        kept = target;
      }
      if (best >= enough) break;
    }
    now = start;
    if (!(kept == start)) place(n, kept);
  }
  void smooth_all(const std::vector<std::int32_t>& nodes, int rounds) {
    for (int round = 0; round < rounds; ++round)
      for (const auto n : nodes) smooth(n, goal + 0.02);
  }

  // Makes a change, smooths the nodes around, and keeps it if that is better as a whole.
  template <class Change>
  bool attempt(std::vector<std::int32_t> nodes, const Change& change) {
    const Score before = score_of(nodes);
    journal = {};
    if (!change(nodes)) {
      undo();
      return false;
    }
    smooth_all(nodes, 3);
    std::erase_if(nodes, [&](std::int32_t n) { return star(n).empty(); });
    const Score after = score_of(nodes);
    if (after.penalty < 0.999 * before.penalty && after.worst >= std::min(before.worst, goal)) return true;
    undo();
    return false;
  }

  std::int32_t opposite(std::int32_t t, std::int32_t a, std::int32_t b) const {
    for (const auto n : mesh.triangle(t))
      if (n != a && n != b) return n;
    return -1;
  }
  std::vector<std::int32_t> ring(std::initializer_list<std::int32_t> centers) const {
    std::vector<std::int32_t> nodes(centers);
    for (const auto n : centers) {
      const auto more = neighbours(mesh, n);
      nodes.insert(nodes.end(), more.begin(), more.end());
    }
    sort_unique(nodes);
    return nodes;
  }

  // The edge between two triangles of one label becomes the other diagonal.
  bool flip(std::int32_t a, std::int32_t b) {
    const auto [t, u] = triangles_at(mesh, a, b);
    if (t < 0 || u < 0 || mesh.label_of(t) != mesh.label_of(u)) return false;
    const auto c = opposite(t, a, b), d = opposite(u, a, b);
    const auto& corners = mesh.triangle(t);
    const auto at = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), a) - corners.begin());
    const bool is_forward = corners[(at + 1) % 3] == b;  // a, b, c is counter-clockwise
    const Face first = is_forward ? Face{a, d, c} : Face{a, c, d}, second = is_forward ? Face{d, b, c} : Face{c, b, d};
    const auto q = [&](const Face& f) { return min_sine(mesh.at(f[0]), mesh.at(f[1]), mesh.at(f[2])); };
    if (std::min(q(first), q(second)) <= std::min(quality(mesh, t), quality(mesh, u))) return false;
    if (triangles_at(mesh, c, d)[0] >= 0) return false;
    journal = {};
    const int label = mesh.label_of(t);
    remove(t);
    remove(u);
    add(first, label);
    add(second, label);
    return true;
  }

  bool follows_curve(std::int32_t a, std::int32_t b, LabelBits bits) const {
    const Vec3 middle = 0.5 * (mesh.at(a) + mesh.at(b));
    return tetmesh::distance_to(tetmesh::feature_at(materials, bits, middle)) <=
           max_deviation * norm(mesh.at(a) - mesh.at(b));
  }
  bool may_shrink(std::int32_t gone, std::int32_t kept) const {
    const LabelBits bits = mesh.bits(gone);
    if (mesh.pinned[static_cast<std::size_t>(gone)] != 0 || (bits & ~mesh.bits(kept)) != 0 || constraints(bits) > 1)
      return false;
    const auto near = neighbours(mesh, gone), far = neighbours(mesh, kept);
    std::vector<std::int32_t> common;
    std::set_intersection(near.begin(), near.end(), far.begin(), far.end(), std::back_inserter(common));
    const auto [t, u] = triangles_at(mesh, gone, kept);
    if (common.size() != (u >= 0 ? 2U : 1U)) return false;
    if (!tetmesh::is_constrained(bits)) return true;
    int interfaces = 0;
    for (const auto n : near) {
      if (!is_interface(mesh, gone, n)) continue;
      ++interfaces;
      if (n != kept && !follows_curve(kept, n, bits)) return false;
    }
    return interfaces == 2 && is_interface(mesh, gone, kept);
  }
  bool shrink(std::int32_t gone, std::int32_t kept) {
    if (!may_shrink(gone, kept)) return false;
    return attempt(ring({gone, kept}), [&](const auto&) {
      for (const auto t : std::vector(star(gone))) {
        Face corners = mesh.triangle(t);
        const int label = mesh.label_of(t);
        remove(t);
        if (std::find(corners.begin(), corners.end(), kept) != corners.end()) continue;
        std::replace(corners.begin(), corners.end(), gone, kept);
        add(corners, label);
      }
      return true;
    });
  }

  std::int32_t new_node(const Vec3& p, LabelBits bits) {
    mesh.nodes_mm.push_back(p);
    mesh.touches.push_back(bits);
    mesh.pinned.push_back(0);
    mesh.star.emplace_back();
    return static_cast<std::int32_t>(mesh.nodes_mm.size()) - 1;
  }
  bool divide(std::int32_t a, std::int32_t b) {
    const auto both = triangles_at(mesh, a, b);
    const auto t = both[0], u = both[1];
    if (t < 0) return false;
    LabelBits bits = bit_of(mesh.label_of(t));
    Vec3 middle = 0.5 * (mesh.at(a) + mesh.at(b));
    if (is_interface(mesh, a, b)) {
      const LabelBits sides = mesh.bits(a) & mesh.bits(b) & tetmesh::side_bits;
      bits |= u >= 0 ? bit_of(mesh.label_of(u)) : sides != 0 ? sides : bit_of(0);
      const Vec3 on_curve = tetmesh::project(materials, bits, middle, 4);
      if (norm(on_curve - middle) < 0.3 * norm(mesh.at(a) - mesh.at(b))) middle = on_curve;
    }
    const auto n = new_node(middle, bits);
    const bool done = attempt(ring({a, b}), [&](auto& nodes) {
      nodes.push_back(n);
      for (const auto old : {t, u}) {
        if (old < 0) continue;
        const Face corners = mesh.triangle(old);
        const int label = mesh.label_of(old);
        remove(old);
        for (const auto end : {a, b}) {
          Face part = corners;
          std::replace(part.begin(), part.end(), end, n);
          add(part, label);
        }
      }
      return true;
    });
    if (!done) {  // the node is the last: nothing refers to it
      mesh.nodes_mm.pop_back();
      mesh.touches.pop_back();
      mesh.pinned.pop_back();
      mesh.star.pop_back();
    }
    return done;
  }

  // A triangle with other labels beyond two or three of its sides is a tip: it goes to the label beyond the longest of
  // these sides (or is dropped where that is the outside).
  bool cut_tip(std::int32_t t) {
    const Face corners = mesh.triangle(t);
    int open_sides = 0;
    double longest = 0;
    int beyond = -1;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = corners[i], b = corners[(i + 1) % 3];
      if (!is_interface(mesh, a, b)) continue;
      ++open_sides;
      const auto both = triangles_at(mesh, a, b);
      const auto other = both[0] == t ? both[1] : both[0];
      // A side of the box is no material: nothing can be cut off there.
      if (other < 0 && (mesh.bits(a) & mesh.bits(b) & tetmesh::side_bits) != 0) continue;
      const double length = norm(mesh.at(b) - mesh.at(a));
      if (length <= longest) continue;
      longest = length;
      beyond = other < 0 ? 0 : mesh.label_of(other);
    }
    if (open_sides < 2 || beyond < 0) return false;
    const Vec3 ab = mesh.at(corners[1]) - mesh.at(corners[0]), ac = mesh.at(corners[2]) - mesh.at(corners[0]);
    const double depth = std::abs(ab.x * ac.y - ab.y * ac.x) / longest;
    if (depth > tip * edge_at(corners[0])) return false;
    journal = {};
    remove(t);
    if (beyond != 0) add(corners, beyond);
    for (const auto n : corners) {
      if (star(n).empty()) continue;
      update_touches(mesh, n);
    }
    return true;
  }

  // A flat triangle whose longest side is an interface, and whose third node lies inside its material: the triangle
  // goes to the other side, and the node onto the interface.
  bool cut_cap(std::int32_t t) {
    const Face corners = mesh.triangle(t);
    const int label = mesh.label_of(t);
    std::size_t apex = 0;
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double length = norm(mesh.at(corners[(i + 1) % 3]) - mesh.at(corners[(i + 2) % 3]));
      if (length > longest) {
        longest = length;
        apex = i;
      }
    }
    const auto r = corners[apex], a = corners[(apex + 1) % 3], b = corners[(apex + 2) % 3];
    if (mesh.bits(r) != bit_of(label) || mesh.pinned[static_cast<std::size_t>(r)] != 0 || !is_interface(mesh, a, b))
      return false;
    const auto both = triangles_at(mesh, a, b);
    const auto other = both[0] == t ? both[1] : both[0];
    const LabelBits sides = mesh.bits(a) & mesh.bits(b) & tetmesh::side_bits;
    const LabelBits beyond = other >= 0 ? bit_of(mesh.label_of(other)) : sides != 0 ? sides : bit_of(0);
    const Vec3 place_of_r = tetmesh::project(materials, bit_of(label) | beyond, mesh.at(r), 4);
    if (norm(place_of_r - mesh.at(r)) > tip * edge_at(r)) return false;
    return attempt(ring({r, a, b}), [&](const auto&) {
      remove(t);
      if (other >= 0) add(corners, mesh.label_of(other));
      touch(r, bit_of(label) | beyond);
      place(r, place_of_r);
      return true;
    });
  }

  template <class Operation>
  bool any_edge(std::int32_t t, const Operation& operation) {
    const Face c = mesh.triangle(t);
    std::array<std::array<std::int32_t, 2>, 3> edges{{{c[0], c[1]}, {c[1], c[2]}, {c[2], c[0]}}};
    const auto length = [&](const auto& e) { return norm(mesh.at(e[1]) - mesh.at(e[0])); };
    std::sort(edges.begin(), edges.end(), [&](const auto& x, const auto& y) { return length(x) < length(y); });
    return std::any_of(edges.begin(), edges.end(), [&](const auto& e) { return operation(e[0], e[1]); });
  }

  void work_on(std::int32_t t, int sweep) {
    const Face corners = mesh.triangle(t);
    journal = {};
    for (const auto n : corners) smooth(n, goal + 0.02);
    if (!is_bad(t) || any_edge(t, [&](auto a, auto b) { return flip(a, b); })) return;
    if (attempt(ring({corners[0], corners[1], corners[2]}), [](const auto&) { return true; }) && !is_bad(t)) return;
    if (any_edge(t, [&](auto a, auto b) { return shrink(a, b) || shrink(b, a); })) return;
    if (sweep >= divide_from && any_edge(t, [&](auto a, auto b) { return divide(a, b); })) return;
    if (sweep >= cut_tips_from && !cut_tip(t)) cut_cap(t);
  }

  // Moves the nodes around at random, smooths them, and keeps what is better as a whole.
  void shake(std::int32_t t, std::uint32_t& noise) {
    constexpr int tries = 12;
    const auto random = [&] {
      noise = noise * 1664525U + 1013904223U;
      return static_cast<double>(noise >> 8U) / 8388608.0 - 1.0;
    };
    for (int i = 0; i < tries && is_bad(t); ++i) {
      const Face corners = mesh.triangle(t);
      attempt(ring({corners[0], corners[1], corners[2]}), [&](const auto& nodes) {
        for (const auto n : nodes) {
          const double reach = (0.05 + 0.03 * (i % 6)) * edge_at(n);
          const double x = random(), y = random();
          Vec3 target = mesh.at(n) + reach * Vec3{x, y, 0};
          if (may_move(n) && settle(n, target)) place(n, target);
        }
        smooth_all(nodes, 3);
        return true;
      });
    }
  }
};

std::vector<std::int32_t> bad_triangles(const Triangles& mesh, double goal) {
  std::vector<std::int32_t> bad;
  for (std::size_t t = 0; t < mesh.corners.size(); ++t)
    if (mesh.corners[t][0] >= 0 && quality(mesh, static_cast<std::int32_t>(t)) < goal)
      bad.push_back(static_cast<std::int32_t>(t));
  return bad;
}

}  // namespace

std::int64_t improve_triangles(Triangles& mesh, const Materials& materials, const TriangleGoal& goal) {
  Improver improver{mesh, materials, math::sin(goal.angle_deg * std::numbers::pi / 180), 0, goal.tip};
  std::uint32_t noise = 1;
  auto bad = bad_triangles(mesh, improver.goal);
  for (int sweep = 0; sweep < goal.sweeps && !bad.empty(); ++sweep) {
    improver.tolerance = sweep < loosen_from ? 0 : goal.tolerance * std::min(1.0, 0.25 * (sweep - loosen_from + 1));
    for (const auto t : bad)
      if (improver.is_bad(t)) improver.work_on(t, sweep);
    if (sweep >= shake_from)
      for (const auto t : bad_triangles(mesh, improver.goal))
        if (improver.is_bad(t)) improver.shake(t, noise);
    bad = bad_triangles(mesh, improver.goal);
  }
  compress(mesh);
  return static_cast<std::int64_t>(bad.size());
}

}  // namespace heartgen::distmesh
