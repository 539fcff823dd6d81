// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/feature.hpp"

#include <algorithm>
#include <cmath>

namespace heartgen::tetmesh {
namespace {

// Level sets are flat in the middle of thick bodies; a step there must not run away.
constexpr double min_slope = 0.02;
constexpr double max_step_mm = 2;

double slope_squared(const Equation& e) { return std::max(dot(e.gradient, e.gradient), min_slope * min_slope); }

// Solves (J J^T + small) x = values for the first `count` (2 or 3) equations of unit slope.
std::array<double, 3> solve(const std::array<Vec3, 3>& g, const std::array<double, 3>& f, int count) {
  constexpr double damping = 1e-3;  // surfaces that meet at a grazing angle
  const auto a = [&](std::size_t i, std::size_t j) { return dot(g[i], g[j]) + (i == j ? damping : 0); };
  if (count == 2) {
    const double det = a(0, 0) * a(1, 1) - a(0, 1) * a(0, 1);
    return {(a(1, 1) * f[0] - a(0, 1) * f[1]) / det, (a(0, 0) * f[1] - a(0, 1) * f[0]) / det, 0};
  }
  const Vec3 r0{a(0, 0), a(0, 1), a(0, 2)}, r1{a(0, 1), a(1, 1), a(1, 2)}, r2{a(0, 2), a(1, 2), a(2, 2)};
  const Vec3 right{f[0], f[1], f[2]};
  const double det = dot(r0, cross(r1, r2));
  return {dot(right, cross(r1, r2)) / det, dot(right, cross(r2, r0)) / det, dot(right, cross(r0, r1)) / det};
}

}  // namespace

Feature feature_at(const Materials& materials, LabelBits touches, const Vec3& point) {
  Feature feature;
  for (int side = 0; side < 6; ++side) {
    if ((touches & bit_of(first_side + side)) == 0 || feature.count == 3) continue;
    const int axis = side / 2;
    auto& e = feature.equations[static_cast<std::size_t>(feature.count++)];
    e.value = point[axis] - (side % 2 == 0 ? materials.box_min_mm : materials.box_max_mm)[axis];
    e.gradient = Vec3{};
    e.gradient[axis] = 1;
  }
  const LabelBits labels = touches & ~side_bits;
  if (is_constrained(labels)) {
    const auto rest = std::span(feature.equations).subspan(static_cast<std::size_t>(feature.count));
    feature.count += materials.equations_at(labels, point, rest);
  }
  return feature;
}

Vec3 step_to(const Feature& feature) {
  const int count = std::min(feature.count, 3);
  if (count == 0) return {};
  std::array<Vec3, 3> g;
  std::array<double, 3> f{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const auto& e = feature.equations[i];
    const double scale = 1 / std::sqrt(slope_squared(e));
    g[i] = scale * e.gradient;
    f[i] = std::clamp(scale * e.value, -max_step_mm, max_step_mm);
  }
  if (count == 1) return -f[0] * g[0];
  const auto x = solve(g, f, count);
  Vec3 step;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) step -= x[i] * g[i];
  const double length = norm(step);
  return length > 2 * max_step_mm ? (2 * max_step_mm / length) * step : step;
}

Vec3 project(const Materials& materials, LabelBits touches, const Vec3& start, int iterations) {
  constexpr double near_mm = 1e-4;
  Vec3 point = start;
  for (int i = 0; i < iterations; ++i) {
    const Vec3 step = step_to(feature_at(materials, touches, point));
    point += step;
    if (dot(step, step) < near_mm * near_mm) break;
  }
  for (int side = 0; side < 6; ++side)  // exactly onto the planes
    if ((touches & bit_of(first_side + side)) != 0)
      point[side / 2] = (side % 2 == 0 ? materials.box_min_mm : materials.box_max_mm)[side / 2];
  return point;
}

double distance_to(const Feature& feature) {
  double farthest = 0;
  for (int i = 0; i < feature.count; ++i) {
    const auto& e = feature.equations[static_cast<std::size_t>(i)];
    farthest = std::max(farthest, std::abs(e.value) / std::sqrt(slope_squared(e)));
  }
  return farthest;
}

Offset offset_at(const Materials& materials, LabelBits labels, const Vec3& point) {
  const auto feature = feature_at(materials, labels, point);
  const auto& e = feature.equations[0];
  const double slope = std::max(norm(e.gradient), min_slope);
  return {e.value / slope, e.gradient / slope};
}

}  // namespace heartgen::tetmesh
