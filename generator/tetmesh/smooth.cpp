// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/smooth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/parallel/simd.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/quality.hpp"
#include "generator/tetmesh/surface_deviation.hpp"

namespace heartgen::tetmesh {
namespace {

constexpr std::size_t max_cells = 128;
constexpr std::size_t max_gradients = 12;
constexpr double min_gain = 1e-4;

/// The cells around a node as the three other corners of each, in coordinate arrays so that the loop vectorises.
struct Star {
  std::size_t size = 0;
  double x[3][max_cells], y[3][max_cells], z[3][max_cells];

  double quality_at(std::size_t i, const Vec3& p) const {
    return cell_quality(p, {x[0][i], y[0][i], z[0][i]}, {x[1][i], y[1][i], z[1][i]}, {x[2][i], y[2][i], z[2][i]});
  }
};
using Qualities = std::array<double, max_cells>;

constexpr std::size_t batch = CellBatch::size;

// Qualities first to first + 3 with the node at `p`; the arrays have room for a whole batch at the end.
HEARTGEN_INLINE void evaluate_batch(const Star& star, std::size_t first, double px, double py, double pz, double* q) {
  for (std::size_t i = 0; i < batch; ++i) q[i] = star.quality_at(first + i, {px, py, pz});
}

// Qualities of cell `i` with the node at each of four places.
HEARTGEN_INLINE void evaluate_places(const Star& star, std::size_t i, const double* x, const double* y, const double* z,
                                     double* q) {
  for (std::size_t k = 0; k < batch; ++k) q[k] = star.quality_at(i, {x[k], y[k], z[k]});
}

// How the quality of cell `i`, `here` with the node at `p`, changes per mm.
Vec3 gradient_of(const Star& star, std::size_t i, const Vec3& p, double here, double step_mm) {
  const std::array x{p.x + step_mm, p.x, p.x, p.x}, y{p.y, p.y + step_mm, p.y, p.y}, z{p.z, p.z, p.z + step_mm, p.z};
  std::array<double, batch> moved;
  parallel::vectorised<evaluate_places>(star, i, x.data(), y.data(), z.data(), moved.data());
  return {(moved[0] - here) / step_mm, (moved[1] - here) / step_mm, (moved[2] - here) / step_mm};
}

// The worst quality with the node at `p`, and all of them in `q`; stops early once one is not above `bound`.
double evaluate(const Star& star, const Vec3& p, double bound, Qualities& q) {
  double worst = 9;
  for (std::size_t first = 0; first < star.size && worst > bound; first += batch) {
    parallel::vectorised<evaluate_batch>(star, first, p.x, p.y, p.z, q.data() + first);
    const std::size_t end = std::min(first + batch, star.size);
    for (std::size_t i = first; i < end; ++i) worst = std::min(worst, q[i]);
  }
  return worst;
}

void gather(const Complex& c, std::int32_t node, Star& star) {
  constexpr std::size_t rest[4][3] = {{1, 2, 3}, {0, 3, 2}, {3, 0, 1}, {2, 1, 0}};
  star.size = 0;
  // Bad cells first: they decide most often.
  std::array<std::pair<float, std::int32_t>, max_cells> order;
  std::size_t count = 0;
  for (const auto t : c.star(node)) order[count++] = {c.quality[static_cast<std::size_t>(t)], t};
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = order[i].second;
    const Cell& cell = c.cell(t);
    const auto place = static_cast<std::size_t>(std::find(cell.begin(), cell.end(), node) - cell.begin());
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = c.at(cell[rest[place][k]]);
      star.x[k][star.size] = p.x;
      star.y[k][star.size] = p.y;
      star.z[k][star.size] = p.z;
    }
    ++star.size;
  }
  for (std::size_t i = star.size; i % batch != 0; ++i)  // something to compute with, never used
    for (std::size_t k = 0; k < 3; ++k) {
      star.x[k][i] = star.x[k][0];
      star.y[k][i] = star.y[k][0];
      star.z[k][i] = star.z[k][0];
    }
}

/// What a node's feature leaves free: the directions orthogonal to its surfaces.
struct Tangents {
  std::array<Vec3, 3> normals;  // orthonormal
  int count = 0;
  Vec3 along(Vec3 v) const {
    for (int i = 0; i < count; ++i) {
      const Vec3& n = normals[static_cast<std::size_t>(i)];
      v -= dot(v, n) * n;
    }
    return v;
  }
};

Tangents tangents_of(const Feature& feature) {
  Tangents tangents;
  for (int i = 0; i < feature.count && tangents.count < 3; ++i) {
    const Vec3 rest = tangents.along(normalized(feature.equations[static_cast<std::size_t>(i)].gradient));
    if (norm(rest) > 0.05) tangents.normals[static_cast<std::size_t>(tangents.count++)] = normalized(rest);
  }
  return tangents;
}

// The shortest vector in the convex hull of the gradients: a direction in which all of them rise (Gilbert's method).
Vec3 common_ascent(const std::array<Vec3, max_gradients>& gradients, std::size_t count) {
  Vec3 d = gradients[0];
  for (std::size_t i = 1; i < count; ++i)
    if (dot(gradients[i], gradients[i]) < dot(d, d)) d = gradients[i];
  for (int round = 0; round < 12 && count > 1; ++round) {
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < count; ++i)
      if (dot(gradients[i], d) < dot(gradients[lowest], d)) lowest = i;
    if (dot(d, d) - dot(gradients[lowest], d) < 1e-3 * dot(d, d)) break;
    const Vec3 way = gradients[lowest] - d;
    d += std::min(1.0, -dot(way, d) / (dot(way, way) + 1e-300)) * way;
  }
  return d;
}

struct Smoother {
  Complex* complex;
  const Materials* materials;
  std::int32_t node;
  double tolerance;
  double spacing;
  LabelBits touches;
  const Star* star;

  bool is_bound() const { return is_constrained(touches); }

  Vec3 direction(const Vec3& position, const Qualities& q, double worst) const {
    const double band = std::max(0.02, 0.05 * std::abs(worst));
    Tangents tangents;
    if (is_bound()) {
      const LabelBits hard = tolerance > 0 ? touches & side_bits : touches;
      tangents = tangents_of(feature_at(*materials, hard, position));
    }
    std::array<Vec3, max_gradients> gradients;
    std::size_t count = 0;
    const double step = 1e-5 * spacing;
    for (std::size_t i = 0; i < star->size && count < max_gradients; ++i) {
      if (q[i] > worst + band) continue;
      gradients[count++] = tangents.along(gradient_of(*star, i, position, q[i], step));
    }
    return common_ascent(gradients, count);
  }
  // The place of the feature near `wanted`; false where it is too far away.
  bool constrain(Vec3& wanted) const {
    if (!is_bound()) return true;
    if (tolerance > 0) return is_allowed(*complex, *materials, node, wanted, tolerance);
    const Vec3 on = project(*materials, touches, wanted, 2);
    const bool is_near = norm(on - wanted) < 0.3 * spacing;
    wanted = on;
    return is_near;
  }
  bool climb(Vec3& position, Qualities& q, double worst, double goal) const {
    constexpr int max_steps = 6, max_tries = 5;
    double step = 0.15 * spacing;
    bool moved = false;
    Qualities tried{};
    for (int i = 0; i < max_steps && worst < goal; ++i) {
      Vec3 way = direction(position, q, worst);
      if (norm(way) * spacing < 0.02) break;
      way = normalized(way);
      bool better = false;
      for (int attempt = 0; attempt < max_tries && !better; ++attempt, step *= 0.4) {
        Vec3 candidate = position + step * way;
        if (!constrain(candidate)) continue;
        const double value = evaluate(*star, candidate, worst + min_gain, tried);
        if (value <= worst + min_gain) continue;
        position = candidate;
        worst = value;
        q = tried;
        better = true;
        step *= 3.75;  // with the shrinking of the loop: half as long again
      }
      if (!better) break;
      moved = true;
    }
    return moved;
  }
};

}  // namespace

bool is_allowed(const Complex& complex, const Materials& materials, std::int32_t node, const Vec3& position,
                double tolerance) {
  const LabelBits touches = complex.bits(node);
  if (!is_constrained(touches)) return true;
  constexpr double rounding = 1e-9;
  for (int side = 0; side < 6; ++side) {
    if ((touches & bit_of(first_side + side)) == 0) continue;
    const double plane = (side % 2 == 0 ? materials.box_min_mm : materials.box_max_mm)[side / 2];
    if (std::abs(position[side / 2] - plane) > rounding) return false;
  }
  const double spacing = static_cast<double>(complex.spacing_mm[static_cast<std::size_t>(node)]);
  return distance_to(feature_at(materials, touches & ~side_bits, position)) <= tolerance * spacing;
}

bool smooth_node(Complex& complex, const Materials& materials, std::int32_t node, double goal,
                 const SurfaceTolerance& surface) {
  const auto cells = complex.star(node);
  if (complex.is_frozen(node) || cells.empty() || cells.size() > max_cells || worst_quality(complex, cells) >= goal)
    return false;
  const auto n = static_cast<std::size_t>(node);
  const double spacing = static_cast<double>(complex.spacing_mm[n]);
  double tolerance = surface.node;
  if (tolerance > 0 && is_constrained(complex.touches[n])) {
    // A node that is farther away already may go no farther.
    const LabelBits labels = complex.touches[n] & ~side_bits;
    tolerance = std::max(tolerance, distance_to(feature_at(materials, labels, complex.nodes_mm[n])) / spacing);
  }
  Star star;  // apart from the smoother: its 9 kB need not be cleared first
  gather(complex, node, star);
  const Smoother smoother{&complex, &materials, node, tolerance, spacing, complex.touches[n], &star};
  Vec3 position = complex.nodes_mm[n];
  Qualities q{};
  const double worst = evaluate(star, position, -9, q);
  if (!smoother.climb(position, q, worst, goal)) return false;
  if (smoother.is_bound() && makes_face_deviate(complex, materials, node, position, -1, surface.face)) return false;
  complex.nodes_mm[n] = position;
  update_qualities(complex, cells);
  return true;
}

}  // namespace heartgen::tetmesh
