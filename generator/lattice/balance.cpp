#include "generator/lattice/balance.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "generator/lattice/feature.hpp"
#include "generator/parallel/threads.hpp"

namespace heart::lattice {
namespace {

// A quadratic surface through the corners of a face is as far from it on average as 3/4 of the distance at its centre.
constexpr double mean_per_center = 0.75;
constexpr double most_shift = 0.1;  // of the lattice's width

// Nodes between two labels, also where their surface ends in a side of the box.
bool is_on_surface(LabelBits touches) { return std::popcount(touches & ~side_bits) == 2; }

/// Signed distance (mm) of a point to the surface between two labels, to first order, and the normal there.
struct Offset {
  double distance = 0;
  Vec3 normal;
};

Offset offset_at(const Materials& materials, LabelBits labels, const Vec3& point) {
  constexpr double least_slope = 0.02;
  const auto feature = feature_at(materials, labels, point);
  const auto& e = feature.equations[0];
  const double slope = std::max(norm(e.gradient), least_slope);
  return {e.value / slope, e.gradient / slope};
}

// The labels' own faces around the node: between cells of both, or of one and nothing.
template <class Visit>
void each_surface_face(const Complex& c, std::int32_t node, Visit&& visit) {
  const LabelBits labels = c.bits(node) & ~side_bits;
  for (const auto t : c.star(node)) {
    const Cell& cell = c.cell(t);
    for (std::size_t i = 0; i < 4; ++i) {
      if (cell[i] == node) continue;
      const auto a = cell[(i + 1) % 4], b = cell[(i + 2) % 4], d = cell[(i + 3) % 4];
      const LabelBits shared = c.bits(a) & c.bits(b) & c.bits(d);
      if ((shared & labels) != labels || (shared & side_bits) != 0) continue;
      const auto pair = cells_at_face(c, a, b, d);
      const bool is_first = pair[0] == t;
      if (is_first && (pair[1] < 0 || c.label_of(pair[0]) != c.label_of(pair[1]))) visit(a, b, d);
    }
  }
}

Vec3 shift_of(const Complex& c, const Materials& materials, std::int32_t node) {
  constexpr double least_slant = 0.5;  // of the surface against the sides
  const LabelBits labels = c.bits(node) & ~side_bits;
  double sum = 0;
  int faces = 0;
  each_surface_face(c, node, [&](std::int32_t a, std::int32_t b, std::int32_t d) {
    sum += offset_at(materials, labels, (c.at(a) + c.at(b) + c.at(d)) / 3).distance;
    ++faces;
  });
  if (faces == 0) return {};
  const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)]);
  const double shift = std::clamp(mean_per_center * sum / faces, -most_shift * spacing, most_shift * spacing);
  Vec3 way = offset_at(materials, labels, c.at(node)).normal;
  for (int side = 0; side < 6; ++side)
    if ((c.bits(node) & bit_of(first_side + side)) != 0) way[side / 2] = 0;
  const double slant = dot(way, way);
  return slant < least_slant ? Vec3{} : -shift / slant * way;
}

}  // namespace

void balance_surfaces(Complex& c, const Materials& materials, double least_quality) {
  const auto count = static_cast<std::int64_t>(c.nodes_mm.size());
  std::vector<Vec3> shift(c.nodes_mm.size());
  parallel::parallel_for(0, count, [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::int32_t>(begin); n < end; ++n)
      if (is_on_surface(c.bits(n))) shift[static_cast<std::size_t>(n)] = shift_of(c, materials, n);
  });
  for (std::int32_t n = 0; n < count; ++n) {
    const Vec3& way = shift[static_cast<std::size_t>(n)];
    if (dot(way, way) == 0) continue;
    auto& position = c.nodes_mm[static_cast<std::size_t>(n)];
    const Vec3 old = position;
    const auto star = c.star(n);
    const double bound = std::min(least_quality, worst_quality(c, star));
    position += way;
    const bool is_bad =
        std::any_of(star.begin(), star.end(), [&](std::int32_t t) { return quality(c, c.cell(t)) < bound; });
    if (is_bad)
      position = old;
    else
      for (const auto t : star) update_quality(c, t);
  }
}

}  // namespace heart::lattice
