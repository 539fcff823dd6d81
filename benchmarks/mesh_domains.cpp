// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/mesh_domains.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "model/mathematics.hpp"

namespace heartgen::benchmarks {
namespace {

// Positive inside; the distance to first order.
double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
  const Vec3 q = p - center;
  const Vec3 u{q.x / radii.x, q.y / radii.y, q.z / radii.z};
  const double size = norm(u);
  const double slope = norm(Vec3{u.x / radii.x, u.y / radii.y, u.z / radii.z});
  if (slope < 1e-12) return std::min({radii.x, radii.y, radii.z});
  return size * (1 - size) / slope;
}

// A rod whose radius goes linearly from one end to the other.
double rod(const Vec3& p, const Vec3& from, const Vec3& to, double first_radius, double last_radius) {
  const Vec3 axis = to - from;
  const double t = std::clamp(dot(p - from, axis) / dot(axis, axis), 0.0, 1.0);
  return first_radius + t * (last_radius - first_radius) - norm(p - (from + t * axis));
}

double wall_of_ventricles(const Vec3& p) {
  const Vec3 left{0, 0, 10}, right{-25, -5, 7};
  const Vec3 left_radii{32, 32, 64}, right_radii{33, 38, 54}, left_wall{9, 9, 9}, right_wall{3.3, 3.3, 3.3};
  const double left_outer = ellipsoid(p, left, left_radii), left_inner = ellipsoid(p, left, left_radii - left_wall);
  const double right_outer = ellipsoid(p, right, right_radii);
  const double right_inner = ellipsoid(p, right, right_radii - right_wall);
  const double left_shell = std::min(left_outer, -left_inner);
  const double right_shell = std::min({right_outer, -right_inner, 4 - left_outer});
  const double muscles =
      std::max(rod(p, {14, 13, 33}, {20, 15, 51}, 3.8, 5.4), rod(p, {-8, 18, 31}, {-11, 22, 49}, 3.5, 5));
  return std::max({left_shell, right_shell, muscles});
}

using Field = std::function<double(const Vec3&)>;

Vec3 gradient_of(const Field& field, const Vec3& p) {
  constexpr double step = 1e-4;
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 up = p, down = p;
    up[axis] += step;
    down[axis] -= step;
    g[axis] = (field(up) - field(down)) / (2 * step);
  }
  return g;
}

}  // namespace

AnalyticDomain ventricles(double edge_mm) { return {{-64, -50, 0}, {38, 38, 80}, {wall_of_ventricles}, edge_mm}; }

AnalyticDomain random_walls(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto number = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() % 10000) / 10000;
  };
  const double wall = number(1.5, 5), bump = number(0, 0.5), wave = number(0.3, 0.8), noise = number(0, 0.15);
  const Vec3 shift{number(-1, 1), number(-1, 1), number(-1, 1)}, turn{number(-1, 1), number(-1, 1), number(-1, 1)};
  const auto ripple = [=](const Vec3& p, double frequency) {
    return math::sin(frequency * p.x) * math::sin(frequency * p.y + 1) * math::sin(frequency * p.z + 2);
  };
  const Field left = [=](const Vec3& p) {
    const Vec3 q = p - shift + 0.3 * cross(turn, p);
    return 7 - std::sqrt(q.x * q.x + 0.6 * q.y * q.y + 0.8 * q.z * q.z) + bump * ripple(p, wave);
  };
  const Field right = [=](const Vec3& p) { return 5 - norm(p - shift - Vec3{9 + 0.5 * wall, 2, 0}); };
  const Field shell = [=](const Vec3& p) { return std::max(left(p), right(p)) + wall + noise * ripple(p, 2.5); };
  return {{-20, -20, -20}, {20, 20, 20}, {left, right, shell}, 1.2};
}

// In the order of the fields: a pool goes before the wall around it. Surfaces are then zeros of single fields, and of
// differences where two pools meet.
tetmesh::Materials materials_of(const AnalyticDomain& domain) {
  std::vector<Field> fields;
  for (const auto& field : domain.fields)
    if (field) fields.push_back(field);
  tetmesh::Materials m;
  m.box_min_mm = domain.box_min_mm;
  m.box_max_mm = domain.box_max_mm;
  m.edge_mm = [edge = domain.edge_mm](const Vec3&) { return edge; };
  m.label_at = [fields](const Vec3& p) {
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (fields[i](p) > 0) return static_cast<int>(i) + 1;
    return 0;
  };
  m.equations_at = [fields](tetmesh::LabelBits labels, const Vec3& p, std::span<tetmesh::Equation> equations) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < fields.size() && std::popcount(labels) > 1 && count < equations.size(); ++i) {
      if ((labels & tetmesh::bit_of(static_cast<int>(i) + 1)) == 0) continue;
      labels &= ~tetmesh::bit_of(static_cast<int>(i) + 1);
      equations[count++] = {fields[i](p), gradient_of(fields[i], p)};
    }
    return static_cast<int>(count);
  };
  return m;
}

}  // namespace heartgen::benchmarks
