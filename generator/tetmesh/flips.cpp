// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/flips.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/quality.hpp"
#include "generator/tetmesh/ring.hpp"
#include "generator/tetmesh/surface_deviation.hpp"

namespace heartgen::tetmesh {
namespace {

constexpr double min_gain = 1e-4;

/// A polygon around an edge, cut into triangles; each makes a cell with either end of the edge (Klincsek's recursion).
struct Filling {
  double worst = 9;
  std::array<std::array<std::uint8_t, longest_ring + 1>, longest_ring + 1> apex{};
};

Filling fill(const Complex& c, std::span<const std::int32_t> polygon, std::int32_t a, std::int32_t b, double bound) {
  Filling filling;
  const std::size_t n = polygon.size();
  std::array<std::array<double, longest_ring + 1>, longest_ring + 1> best;
  for (std::size_t i = 0; i + 1 < n; ++i) best[i][i + 1] = 9;
  const auto at = [&](std::size_t i) { return c.at(polygon[i]); };
  const Vec3 pa = c.at(a), pb = c.at(b);
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      best[i][j] = -1;
      for (std::size_t k = i + 1; k < j; ++k) {
        double value = std::min(best[i][k], best[k][j]);
        const auto helps = [&] { return value > bound && value > best[i][j]; };
        if (helps()) value = std::min(value, cell_quality(at(i), at(k), at(j), pb));
        if (helps()) value = std::min(value, cell_quality(at(i), at(j), at(k), pa));
        if (!helps()) continue;
        best[i][j] = value;
        filling.apex[i][j] = static_cast<std::uint8_t>(k);
      }
    }
  filling.worst = n < 2 ? -1 : best[0][n - 1];
  return filling;
}

void add_filling(Complex& c, std::span<const std::int32_t> polygon, std::int32_t a, std::int32_t b,
                 const Filling& filling, int label) {
  std::array<std::array<std::size_t, 2>, 2 * longest_ring> open;
  std::size_t count = 0;
  open[count++] = {0, polygon.size() - 1};
  while (count > 0) {
    const auto [i, j] = open[--count];
    if (j - i < 2) continue;
    const std::size_t k = filling.apex[i][j];
    add_cell(c, {polygon[i], polygon[k], polygon[j], b}, label);
    add_cell(c, {polygon[i], polygon[j], polygon[k], a}, label);
    open[count++] = {i, k};
    open[count++] = {k, j};
  }
}

// Whether the surface may turn its diagonal from ab to first-last.
bool may_turn(const Complex& c, const Materials& materials, const Ring& ring, std::int32_t a, std::int32_t b,
              std::int32_t first, std::int32_t last, const SurfaceTolerance& tolerance) {
  if (c.is_frozen(a) && c.is_frozen(b)) return false;
  // What the two faces separate: both must be the same surface.
  LabelBits labels = bit_of(c.label_of(ring.cells[0]));
  if (ring.is_open) {
    const LabelBits beyond = beyond_face(c, a, b, first);
    if (beyond != beyond_face(c, a, b, last)) return false;
    if ((c.bits(first) & c.bits(last) & beyond) == 0) return false;
    labels |= beyond;
  } else {
    labels |= bit_of(c.label_of(ring.cells[ring.arcs[1]]));
  }
  if ((labels & c.bits(a) & c.bits(b) & c.bits(first) & c.bits(last)) != labels) return false;
  // The new edge must be new, or lie inside the material that gives way.
  const bool one_cell = ring.is_open ? ring.size == 1 : ring.arcs[1] == 1 || ring.size - ring.arcs[1] == 1;
  if (is_edge(c, first, last)) {
    if (!one_cell) return false;
    const int inside = c.label_of(ring.cells[ring.is_open || ring.arcs[1] == 1 ? 0 : ring.arcs[1]]);
    const auto around = ring_around(c, first, last);
    if (around.size == 0 || around.is_open || around.arc_count != 1 || c.label_of(around.cells[0]) != inside)
      return false;
  }
  if ((labels & side_bits) != 0 && std::popcount(labels & ~side_bits) == 1) return true;  // stays in its plane
  const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(first)]);
  const Vec3 middle = 0.5 * (c.at(first) + c.at(last));
  if (distance_to(feature_at(materials, labels, middle)) > tolerance.middle * spacing) return false;
  const auto fits_all = [&](std::int32_t p, std::int32_t q, std::int32_t r, std::int32_t t) {  // faces pqr and pqt
    return fits(materials, labels, {c.at(p), c.at(q), c.at(r)}, tolerance.face) &&
           fits(materials, labels, {c.at(p), c.at(q), c.at(t)}, tolerance.face);
  };
  return std::isinf(tolerance.face) || fits_all(first, last, a, b) || !fits_all(a, b, first, last);
}

// A cell that holds the outer surface's edge alone goes; both other faces of it become outer ones.
bool peel(Complex& c, const Ring& ring, std::int32_t a, std::int32_t b, std::int32_t first, std::int32_t last) {
  if (cells_at_face(c, a, first, last)[1] < 0 || cells_at_face(c, b, first, last)[1] < 0) return false;
  remove_cell(c, ring.cells[0]);
  return true;
}

bool exchange_inside(Complex& c, const Ring& ring, std::int32_t a, std::int32_t b, double bound) {
  if (ring.size < 3) return false;
  const std::span polygon(ring.nodes.data(), ring.size);
  const auto filling = fill(c, polygon, a, b, bound);
  if (filling.worst <= bound) return false;
  const int label = c.label_of(ring.cells[0]);
  for (std::size_t i = 0; i < ring.size; ++i) remove_cell(c, ring.cells[i]);
  add_filling(c, polygon, a, b, filling, label);
  return true;
}

bool exchange_on_surface(Complex& c, const Materials& materials, const Ring& ring, std::int32_t a, std::int32_t b,
                         double bound, const SurfaceTolerance& tolerance) {
  const std::size_t turn = ring.is_open ? ring.size : ring.arcs[1];
  const std::int32_t first = ring.nodes[0], last = ring.nodes[turn];
  if (!may_turn(c, materials, ring, a, b, first, last, tolerance)) return false;
  if (ring.is_open && ring.size == 1) return peel(c, ring, a, b, first, last);
  const std::span one(ring.nodes.data(), turn + 1);
  const auto filling = fill(c, one, a, b, bound);
  if (filling.worst <= bound) return false;
  const int label = c.label_of(ring.cells[0]);
  if (ring.is_open) {
    for (std::size_t i = 0; i < ring.size; ++i) remove_cell(c, ring.cells[i]);
    add_filling(c, one, a, b, filling, label);
    return true;
  }
  const std::span two(ring.nodes.data() + turn, ring.size - turn + 1);
  const auto other = fill(c, two, a, b, bound);
  if (other.worst <= bound) return false;
  const int other_label = c.label_of(ring.cells[turn]);
  for (std::size_t i = 0; i < ring.size; ++i) remove_cell(c, ring.cells[i]);
  add_filling(c, one, a, b, filling, label);
  add_filling(c, two, a, b, other, other_label);
  return true;
}

}  // namespace

bool remove_edge(Complex& c, const Materials& materials, std::int32_t a, std::int32_t b,
                 const SurfaceTolerance& tolerance) {
  const auto ring = ring_around(c, a, b);
  if (ring.size == 0) return false;
  const double old = worst_quality(c, std::span(ring.cells.data(), ring.size));
  if (old <= 0) return false;
  const double bound = old + min_gain;
  if (!ring.is_open && ring.arc_count == 1) return exchange_inside(c, ring, a, b, bound);
  if (ring.arc_count == (ring.is_open ? 1U : 2U))
    return exchange_on_surface(c, materials, ring, a, b, bound, tolerance);
  return false;
}

bool remove_face(Complex& c, std::int32_t id, std::size_t corner) {
  const Cell cell = c.cell(id);
  const std::int32_t x = cell[(corner + 1) % 4], y = cell[(corner + 2) % 4], z = cell[(corner + 3) % 4];
  const auto pair = cells_at_face(c, x, y, z);
  if (pair[1] < 0 || c.label_of(pair[0]) != c.label_of(pair[1])) return false;
  const std::int32_t other = pair[0] == id ? pair[1] : pair[0];
  std::int32_t far = -1;
  for (const auto n : c.cell(other))
    if (n != x && n != y && n != z) far = n;
  const double old = std::min(c.quality_of(id), c.quality_of(other));
  if (old <= 0 || is_edge(c, cell[corner], far)) return false;
  std::array<Cell, 3> made{cell, cell, cell};
  const std::array dropped{x, y, z};
  for (std::size_t i = 0; i < 3; ++i) {
    std::replace(made[i].begin(), made[i].end(), dropped[i], far);
    if (quality(c, made[i]) <= old + min_gain) return false;
  }
  const int label = c.label_of(id);
  remove_cell(c, id);
  remove_cell(c, other);
  for (const auto& m : made) add_cell(c, m, label);
  return true;
}

namespace {

// Corners (bits 0-3), edges (4-9) and faces (10-13) of a tetrahedron, by their places in the cell.
constexpr std::array<std::array<std::size_t, 2>, 6> edge_ends{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

// Five walls and chambers meet where atria, ventricles and a great vessel do, and the outside; every set of them is
// looked at.
constexpr std::size_t max_labels = 7;
constexpr int outside = 0;

/// What the other cells around a cell share with it, per label: which of its corners, edges and faces.
struct Contacts {
  std::array<int, max_labels> labels{};  // of the neighbours
  std::array<std::uint32_t, max_labels> parts{};
  std::size_t count = 0;
};

std::uint32_t shared_parts(const Cell& cell, const Cell& other) {
  std::uint32_t corners = 0;
  for (std::size_t i = 0; i < 4; ++i) corners |= has(other, cell[i]) ? 1U << i : 0U;
  std::uint32_t parts = corners;
  for (std::size_t e = 0; e < 6; ++e)
    if ((corners >> edge_ends[e][0] & corners >> edge_ends[e][1] & 1U) != 0) parts |= 1U << (4 + e);
  for (std::size_t f = 0; f < 4; ++f)
    if ((corners | 1U << f) == 0xFU) parts |= 1U << (10 + f);
  return parts;
}

// What the outside and the sides of the box share with a cell. Of edges whose ring is not seen, it is assumed.
std::uint32_t outer_parts(const Complex& c, const Cell& cell) {
  std::uint32_t parts = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if ((c.bits(cell[i]) & (side_bits | bit_of(outside))) != 0) parts |= 1U << i;
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [i, j] = edge_ends[e];
    if ((parts >> i & parts >> j & 1U) == 0) continue;
    const auto ring = ring_around(c, cell[i], cell[j]);
    if (ring.size == 0 || ring.is_open) parts |= 1U << (4 + e);
  }
  for (std::size_t f = 0; f < 4; ++f)
    if (cells_at_face(c, cell[(f + 1) % 4], cell[(f + 2) % 4], cell[(f + 3) % 4])[1] < 0) parts |= 1U << (10 + f);
  return parts;
}

// Empty where more labels meet than there is room for.
Contacts contacts_of(const Complex& c, std::int32_t id) {
  Contacts contacts;
  const Cell cell = c.cell(id);
  if (const auto parts = outer_parts(c, cell); parts != 0) {
    contacts.labels[contacts.count] = outside;
    contacts.parts[contacts.count++] = parts;
  }
  for (const auto n : cell)
    for (const auto t : c.star(n)) {
      if (t == id) continue;
      std::size_t i = 0;
      while (i < contacts.count && contacts.labels[i] != c.label_of(t)) ++i;
      if (i == contacts.labels.size()) return {};
      if (i == contacts.count) contacts.labels[contacts.count++] = c.label_of(t);
      contacts.parts[i] |= shared_parts(cell, c.cell(t));
    }
  return contacts;
}

// Whether these parts of a tetrahedron's boundary are a disc: faces that hang together, with nothing but their own
// edges and corners.
bool is_disc(std::uint32_t parts) {
  const std::uint32_t faces = parts >> 10U;
  if (faces == 0 || faces == 0xFU) return false;
  std::uint32_t own = faces << 10U;  // any two faces of a tetrahedron share an edge
  for (std::size_t f = 0; f < 4; ++f)
    if ((faces >> f & 1U) != 0) {
      own |= 0xFU & ~(1U << f);
      for (std::size_t e = 0; e < 6; ++e)
        if (edge_ends[e][0] != f && edge_ends[e][1] != f) own |= 1U << (4 + e);
    }
  return own == parts;
}

// No set of labels changes its topology when the cell goes from `own` to `other`: not the two, not together with any
// of the labels around or the outside. (A set can keep its own where its complement does not: inside a region that
// reaches the outside in an edge, a cell of another label parts the region there.)
bool keeps_topology(const Contacts& contacts, int own, int other) {
  for (std::uint32_t set = 1; set < 1U << contacts.count; ++set) {
    bool has_own = false, has_other = false;
    std::uint32_t parts = 0;
    for (std::size_t i = 0; i < contacts.count; ++i) {
      if ((set >> i & 1U) == 0) continue;
      has_own = has_own || contacts.labels[i] == own;
      has_other = has_other || contacts.labels[i] == other;
      parts |= contacts.parts[i];
    }
    if (has_own != has_other && !is_disc(parts)) return false;
  }
  return true;
}

// Around a frozen node there may be cells that are not seen.
bool has_frozen_node(const Complex& c, const Cell& cell) {
  return std::any_of(cell.begin(), cell.end(), [&](auto n) { return c.is_frozen(n); });
}

// What a node touches: the outside as before, and the labels of its cells.
void renew_touches(Complex& c, std::int32_t node) {
  auto& bits = c.touches[static_cast<std::size_t>(node)];
  bits &= side_bits | bit_of(outside);
  for (const auto t : c.star(node)) bits |= bit_of(c.label_of(t));
}

void give_label(Complex& c, std::int32_t id, int label) {
  c.label[static_cast<std::size_t>(id)] = static_cast<std::uint8_t>(label);
  for (const auto n : c.cell(id)) renew_touches(c, n);
}

// Gives a cell to the outside.
void take_away(Complex& c, std::int32_t id) {
  const Cell cell = c.cell(id);
  remove_cell(c, id);
  for (const auto n : cell) {
    c.touches[static_cast<std::size_t>(n)] |= bit_of(outside);
    renew_touches(c, n);
  }
}

}  // namespace

bool relabel(Complex& c, std::int32_t id, int label) {
  if (has_frozen_node(c, c.cell(id))) return false;
  const auto contacts = contacts_of(c, id);
  const auto* end = contacts.labels.begin() + contacts.count;
  if (std::find(contacts.labels.begin(), end, label) == end || !keeps_topology(contacts, c.label_of(id), label))
    return false;
  if (label == outside)
    take_away(c, id);
  else
    give_label(c, id, label);
  return true;
}

bool relabel_spike(Complex& c, std::int32_t id) {
  const Cell cell = c.cell(id);
  const int own = c.label_of(id);
  if (has_frozen_node(c, cell)) return false;
  for (std::size_t i = 0; i < 4; ++i)
    if (cells_at_face(c, cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4])[1] < 0) return false;
  const auto contacts = contacts_of(c, id);
  int other = -1, max_faces = 0;
  for (std::size_t i = 0; i < contacts.count; ++i) {
    const int faces = std::popcount(contacts.parts[i] >> 10U);
    if (contacts.labels[i] == own || contacts.labels[i] == outside || faces <= max_faces ||
        !keeps_topology(contacts, own, contacts.labels[i]))
      continue;
    other = contacts.labels[i];
    max_faces = faces;
  }
  if (other < 0) return false;
  give_label(c, id, other);
  return true;
}

}  // namespace heartgen::tetmesh
