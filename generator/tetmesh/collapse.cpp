// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/collapse.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/quality.hpp"
#include "generator/tetmesh/ring.hpp"
#include "generator/tetmesh/smooth.hpp"
#include "generator/tetmesh/surface_deviation.hpp"
#include "generator/tetmesh/surface_faces.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::tetmesh {
namespace {

constexpr double min_gain = 1e-4;
constexpr double min_quality = 0.1;  // a contraction that leaves worse cells behind is of no use
constexpr std::size_t max_cells = 120;

// Labels of the cells around an edge, and what lies beyond where it is an outer one.
LabelBits touches_of(const Complex& c, const Ring& ring, std::int32_t a, std::int32_t b) {
  LabelBits bits = 0;
  for (std::size_t i = 0; i < ring.size; ++i) bits |= bit_of(c.label_of(ring.cells[i]));
  if (ring.is_open) bits |= beyond_face(c, a, b, ring.nodes[0]) | beyond_face(c, a, b, ring.nodes[ring.size]);
  return bits;
}

std::vector<std::int32_t> neighbours(const Complex& c, std::int32_t node) {
  std::vector<std::int32_t> nodes;
  for (const auto t : c.star(node))
    for (const auto n : c.cell(t))
      if (n != node) nodes.push_back(n);
  sort_unique(nodes);
  return nodes;
}

// The link condition: nodes next to both ends are those around the edge.
bool shares_only_ring(const Complex& c, const Ring& ring, std::int32_t a, std::int32_t b) {
  const auto of_a = neighbours(c, a), of_b = neighbours(c, b);
  std::vector<std::int32_t> common;
  std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(common));
  return common.size() == ring.size + (ring.is_open ? 1 : 0);
}

// No two sheets of a surface, and no two curves, are glued together where a face shrinks to an edge.
bool glues_features(const Complex& c, const Ring& ring, std::int32_t kept, std::int32_t gone) {
  const std::size_t nodes = ring.size + (ring.is_open ? 1 : 0);
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto n = ring.nodes[i];
    if (!is_constrained(c.bits(n))) continue;
    const auto other = ring_around(c, gone, n);
    if (other.size == 0) return true;
    const int at_gone = std::popcount(touches_of(c, other, gone, n));
    if (at_gone < 2) continue;
    const auto own = ring_around(c, kept, n);
    if (own.size == 0) return true;
    const int at_kept = std::popcount(touches_of(c, own, kept, n));
    if (at_kept < 2) continue;
    const auto pair = cells_at_face(c, kept, gone, n);
    const bool on_surface = pair[1] < 0 || c.label_of(pair[0]) != c.label_of(pair[1]);
    if (!on_surface || (at_gone > 2 && at_kept > 2)) return true;
  }
  return false;
}

// New edges on surfaces keep near to them.
bool leaves_surface(const Complex& c, const Materials& materials, std::int32_t kept, std::int32_t gone,
                    const Vec3& position, double tolerance) {
  const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(kept)]);
  for (const auto n : neighbours(c, gone)) {
    const LabelBits shared = c.bits(n) & c.bits(gone);
    if (n == kept || !is_constrained(shared)) continue;
    if ((shared & side_bits) != 0 && std::popcount(shared & ~side_bits) < 2) continue;
    const auto ring = ring_around(c, gone, n);
    const LabelBits touches = touches_of(c, ring, gone, n);
    if (ring.size == 0 || !is_constrained(touches & ~side_bits)) continue;
    const Vec3 middle = 0.5 * (position + c.at(n));
    if (distance_to(feature_at(materials, touches & ~side_bits, middle)) > tolerance * spacing) return true;
  }
  return false;
}

double worst_after(const Complex& c, std::int32_t moved, std::int32_t other, const Vec3& position, double stop) {
  double worst = 9;
  for (const auto t : c.star(moved)) {
    const Cell& cell = c.cell(t);
    if (has(cell, other)) continue;
    const auto at = [&](std::size_t i) { return cell[i] == moved ? position : c.at(cell[i]); };
    worst = std::min(worst, cell_quality(at(0), at(1), at(2), at(3)));
    if (worst <= stop) break;
  }
  return worst;
}

struct Merge {
  Vec3 position;
  double gain = 0;
};

/// What a merge must make of the cells around it: better ones than the worst was, or sound ones.
enum class Bound { before, sound };

// The best of the two ends and the middle.
Merge best_merge(const Complex& c, const Materials& materials, std::int32_t kept, std::int32_t gone, Bound kind) {
  std::array<Vec3, 3> places{c.at(kept)};
  std::size_t count = 1;
  if (c.bits(kept) == c.bits(gone) && !c.is_frozen(kept)) {
    places[count++] = project(materials, c.bits(kept), 0.5 * (c.at(kept) + c.at(gone)), 3);
    places[count++] = c.at(gone);
  }
  const double at_gone = worst_quality(c, c.star(gone));
  const double at_both = std::min(at_gone, worst_quality(c, c.star(kept)));
  Merge best;
  for (std::size_t i = 0; i < count; ++i) {
    const double old = kind == Bound::before ? (i == 0 ? at_gone : at_both) + min_gain : 0;
    const double bound = std::max(old, min_quality);
    double worst = worst_after(c, gone, kept, places[i], bound);
    if (i > 0 && worst > bound) worst = std::min(worst, worst_after(c, kept, gone, places[i], bound));
    if (worst - bound > best.gain) best = {places[i], worst - bound};
  }
  return best;
}

// Cells around an edge one end of which may go into the other; none where it may not.
Ring ring_to_shrink(const Complex& c, std::int32_t kept, std::int32_t gone) {
  const LabelBits bits = c.bits(gone);
  if (c.is_frozen(gone) || (bits & ~c.bits(kept)) != 0 || c.star(kept).size() + c.star(gone).size() > max_cells)
    return {};
  const auto ring = ring_around(c, kept, gone);
  return ring.size == 0 || touches_of(c, ring, kept, gone) != bits ? Ring{} : ring;
}

bool keeps_topology(const Complex& c, const Ring& ring, std::int32_t kept, std::int32_t gone) {
  return shares_only_ring(c, ring, kept, gone) &&
         !(is_constrained(c.bits(gone)) && glues_features(c, ring, kept, gone));
}

void merge_into(Complex& c, std::int32_t kept, std::int32_t gone, const Vec3& position) {
  c.nodes_mm[static_cast<std::size_t>(kept)] = position;
  const std::vector<std::int32_t> star(c.star(gone).begin(), c.star(gone).end());
  for (const auto t : star) {
    Cell cell = c.cell(t);
    const int label = c.label_of(t);
    remove_cell(c, t);
    if (has(cell, kept)) continue;
    std::replace(cell.begin(), cell.end(), gone, kept);
    add_cell(c, cell, label);
  }
  update_qualities(c, c.star(kept));
}

}  // namespace

bool collapse_edge(Complex& c, const Materials& materials, std::int32_t kept, std::int32_t gone,
                   const SurfaceTolerance& tolerance) {
  const LabelBits bits = c.bits(gone);
  const auto ring = ring_to_shrink(c, kept, gone);
  if (ring.size == 0) return false;
  const auto merge = best_merge(c, materials, kept, gone, Bound::before);
  if (merge.gain <= 0 || !keeps_topology(c, ring, kept, gone)) return false;
  if (is_constrained(bits) && (leaves_surface(c, materials, kept, gone, merge.position, tolerance.middle) ||
                               makes_face_deviate(c, materials, gone, merge.position, kept, tolerance.face) ||
                               makes_face_deviate(c, materials, kept, merge.position, gone, tolerance.face)))
    return false;
  merge_into(c, kept, gone, merge.position);
  return true;
}

bool shrink_edge(Complex& c, const Materials& materials, std::int32_t kept, std::int32_t gone) {
  const auto ring = ring_to_shrink(c, kept, gone);
  if (ring.size == 0) return false;
  const auto merge = best_merge(c, materials, kept, gone, Bound::sound);
  if (merge.gain <= 0 || !keeps_topology(c, ring, kept, gone)) return false;
  merge_into(c, kept, gone, merge.position);
  return true;
}

std::int32_t bisect_edge(Complex& c, const Materials& materials, std::int32_t a, std::int32_t b) {
  const auto ring = ring_around(c, a, b);
  if (ring.size == 0) return -1;
  const LabelBits touches = touches_of(c, ring, a, b);
  if (is_constrained(touches) && c.is_frozen(a) && c.is_frozen(b)) return -1;
  const Vec3 middle = project(materials, touches, 0.5 * (c.at(a) + c.at(b)), 3);
  const auto at = [&](std::int32_t n) { return c.spacing_mm[static_cast<std::size_t>(n)]; };
  const auto node = add_node(c, middle, touches, std::min(at(a), at(b)));
  std::vector<std::pair<Cell, int>> before;
  for (std::size_t i = 0; i < ring.size; ++i) {
    before.emplace_back(c.cell(ring.cells[i]), c.label_of(ring.cells[i]));
    remove_cell(c, ring.cells[i]);
  }
  for (const auto& [cell, label] : before)
    for (const auto replaced : {a, b}) {
      Cell made = cell;
      std::replace(made.begin(), made.end(), replaced, node);
      add_cell(c, made, label);
    }
  return node;
}

namespace {

// Where a label begins or ends along a way, at most its length away.
std::optional<Vec3> find_change(const Materials& materials, int label, const Vec3& from, const Vec3& way) {
  constexpr int steps = 16, halvings = 6;
  const bool is_in = materials.label_at(from) == label;
  const auto is_beyond = [&](double share) { return (materials.label_at(from + share * way) == label) != is_in; };
  for (int step = 1; step <= steps; ++step) {
    double low = static_cast<double>(step - 1) / steps, high = static_cast<double>(step) / steps;
    if (!is_beyond(high)) continue;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      (is_beyond(middle) ? high : low) = middle;
    }
    return from + 0.5 * (low + high) * way;
  }
  return std::nullopt;
}

}  // namespace

std::int32_t split_face(Complex& c, const Materials& materials, const Face& face) {
  constexpr double reach = 0.8;  // of the face's edges
  const auto cells = cells_at_face(c, face[0], face[1], face[2]);
  if (cells[0] < 0 || std::all_of(face.begin(), face.end(), [&](std::int32_t n) { return c.is_frozen(n); })) return -1;
  const Vec3 middle = (c.at(face[0]) + c.at(face[1]) + c.at(face[2])) / 3;
  const Vec3 normal = cross(c.at(face[1]) - c.at(face[0]), c.at(face[2]) - c.at(face[0]));
  const Cell first = c.cell(cells[0]);
  const auto apex = *std::find_if(first.begin(), first.end(),
                                  [&](std::int32_t n) { return std::find(face.begin(), face.end(), n) == face.end(); });
  const int label = c.label_of(cells[0]);
  // What is still of the first cell's label ends beyond the face, what is not begins on this side of it.
  const bool is_beyond = materials.label_at(middle) == label;
  const bool is_away = dot(normal, c.at(apex) - middle) < 0;
  const Vec3 way = (is_beyond == is_away ? reach : -reach) / std::sqrt(norm(normal)) * normal;
  const auto place = find_change(materials, label, middle, way);
  if (!place) return -1;
  const LabelBits other = cells[1] >= 0 ? bit_of(c.label_of(cells[1])) : beyond_face(c, face[0], face[1], face[2]);
  const auto width = [&](std::int32_t n) { return c.spacing_mm[static_cast<std::size_t>(n)]; };
  const auto node =
      add_node(c, *place, bit_of(label) | other, std::min({width(face[0]), width(face[1]), width(face[2])}));
  for (const auto id : cells) {
    if (id < 0) continue;
    const Cell old = c.cell(id);
    const int old_label = c.label_of(id);
    remove_cell(c, id);
    for (const auto replaced : face) {
      Cell made = old;
      std::replace(made.begin(), made.end(), replaced, node);
      add_cell(c, made, old_label);
    }
  }
  return node;
}

bool split_edge(Complex& c, const Materials& materials, std::int32_t a, std::int32_t b, double goal,
                const SurfaceTolerance& tolerance) {
  constexpr double shortest = 0.5;  // in lattice widths: dividing again and again only makes the bad cells smaller
  const double width = static_cast<double>(
      std::min(c.spacing_mm[static_cast<std::size_t>(a)], c.spacing_mm[static_cast<std::size_t>(b)]));
  if (norm(c.at(a) - c.at(b)) < shortest * width) return false;
  const auto ring = ring_around(c, a, b);
  if (ring.size == 0) return false;
  const double old = worst_quality(c, std::span(ring.cells.data(), ring.size));
  if (old <= 0) return false;
  std::vector<std::pair<Cell, int>> before;
  for (std::size_t i = 0; i < ring.size; ++i) before.emplace_back(c.cell(ring.cells[i]), c.label_of(ring.cells[i]));
  const auto node = bisect_edge(c, materials, a, b);
  if (node < 0) return false;
  for (int i = 0; i < 3; ++i) smooth_node(c, materials, node, goal, tolerance);
  if (worst_quality(c, c.star(node)) > old + 10 * min_gain) return true;
  const std::vector<std::int32_t> made(c.star(node).begin(), c.star(node).end());
  for (const auto t : made) remove_cell(c, t);
  for (const auto& [cell, label] : before) add_cell(c, cell, label);
  return false;
}

}  // namespace heartgen::tetmesh
