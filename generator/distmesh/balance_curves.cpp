// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/balance_curves.hpp"

#include <algorithm>
#include <numbers>

#include "generator/tetmesh/feature.hpp"
#include "model/mathematics.hpp"

namespace heartgen::distmesh {
namespace {

constexpr double mean_per_middle = 2.0 / 3;
constexpr double max_shift = 0.1;  // of the edge

/// The way from a point to the curve between two labels, to first order.
Vec3 way_to_curve(const Materials& materials, LabelBits labels, const Vec3& point) {
  return tetmesh::step_to(tetmesh::feature_at(materials, labels, point));
}

Vec3 shift_of(const Triangles& mesh, const Materials& materials, std::int32_t node) {
  const LabelBits labels = mesh.bits(node);
  Vec3 sum;
  int sides = 0;
  for (const auto other : neighbours(mesh, node)) {
    if ((labels & ~mesh.bits(other)) != 0 || !is_interface(mesh, node, other)) continue;
    sum += way_to_curve(materials, labels, 0.5 * (mesh.at(node) + mesh.at(other)));
    ++sides;
  }
  if (sides != 2) return {};  // the end of a curve, or more than one through the node
  // What the node is off already belongs to the error of its sides' middles.
  const Vec3 shift = mean_per_middle / sides * sum;
  const double most = max_shift * materials.edge_mm(mesh.at(node)), length = norm(shift);
  return length > most ? most / length * shift : shift;
}

double worst_around(const Triangles& mesh, std::int32_t node) {
  double worst = 1;
  for (const auto t : mesh.star[static_cast<std::size_t>(node)]) worst = std::min(worst, quality(mesh, t));
  return worst;
}

}  // namespace

void balance_curves(Triangles& mesh, const Materials& materials, double min_deg) {
  const double least = math::sin(min_deg * std::numbers::pi / 180);
  std::vector<Vec3> shift(mesh.nodes_mm.size());
  for (std::size_t n = 0; n < shift.size(); ++n) {
    const LabelBits bits = mesh.touches[n];
    if (mesh.pinned[n] == 0 && (bits & tetmesh::side_bits) == 0 && std::popcount(bits) == 2)
      shift[n] = shift_of(mesh, materials, static_cast<std::int32_t>(n));
  }
  for (std::size_t n = 0; n < shift.size(); ++n) {
    if (dot(shift[n], shift[n]) == 0) continue;
    const auto node = static_cast<std::int32_t>(n);
    const Vec3 old = mesh.nodes_mm[n];
    const double bound = std::min(least, worst_around(mesh, node));
    mesh.nodes_mm[n] = old + shift[n];
    if (worst_around(mesh, node) < bound) mesh.nodes_mm[n] = old;
  }
}

}  // namespace heartgen::distmesh
