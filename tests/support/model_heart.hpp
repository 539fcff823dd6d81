// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A small analytic pair of ventricles for tests of the fibre stages: truncated ellipsoids with a known axis field.
/// Own frame: apex to -z, cut flat at z = base_mm, right ventricle on the -x side, y free (a mirror image in y is a
/// different heart only through its fibres).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "model/labels.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::testing {

/// x_world = scale * rotation * x_heart + offset
struct HeartPose {
  Mat3 rotation;
  double scale = 1;
  Vec3 offset_mm;
  Vec3 to_world(const Vec3& x) const { return scale * (rotation * x) + offset_mm; }
  Vec3 to_heart(const Vec3& x) const { return (1 / scale) * (transposed(rotation) * (x - offset_mm)); }
};

inline Mat3 rotation_about(const Vec3& unit, double angle_deg) {
  const double a = angle_deg * std::acos(-1.0) / 180, c = std::cos(a), s = std::sin(a);
  Mat3 m;
  const Vec3 k = unit;
  m[0] = {c + k.x * k.x * (1 - c), k.x * k.y * (1 - c) - k.z * s, k.x * k.z * (1 - c) + k.y * s};
  m[1] = {k.y * k.x * (1 - c) + k.z * s, c + k.y * k.y * (1 - c), k.y * k.z * (1 - c) - k.x * s};
  m[2] = {k.z * k.x * (1 - c) - k.y * s, k.z * k.y * (1 - c) + k.x * s, c + k.z * k.z * (1 - c)};
  return m;
}

struct ModelHeart {
  double wall_mm = 10, rv_wall_mm = 5, base_mm = 18;
  HeartPose pose;
};

namespace model_heart_detail {

/// About the distance to the ellipsoid with the given half axes, and its gradient's direction.
struct Ellipsoid {
  Vec3 center, radii;
  double distance(const Vec3& x) const {
    const Vec3 d = x - center;
    const Vec3 q{d.x / radii.x, d.y / radii.y, d.z / radii.z};
    const Vec3 g{q.x / radii.x, q.y / radii.y, q.z / radii.z};
    const double f = norm(q);
    return norm(g) > 1e-9 ? f * (f - 1) / norm(g) : -radii.x;
  }
  Vec3 normal(const Vec3& x) const {
    const Vec3 d = x - center;
    return normalized({d.x / (radii.x * radii.x), d.y / (radii.y * radii.y), d.z / (radii.z * radii.z)});
  }
};

inline Ellipsoid grown(Ellipsoid e, double mm) {
  e.radii += Vec3{mm, mm, mm};
  return e;
}

}  // namespace model_heart_detail

inline model_heart_detail::Ellipsoid lv_inner(const ModelHeart&) { return {{0, 0, 0}, {18, 18, 50}}; }
inline model_heart_detail::Ellipsoid rv_inner(const ModelHeart&) { return {{-22, 4, 4}, {24, 27, 44}}; }

inline Region region_of(const ModelHeart& heart, const Vec3& world_mm) {
  const Vec3 x = heart.pose.to_heart(world_mm);
  if (x.z > heart.base_mm) return Region::none;
  const auto lv = lv_inner(heart), rv = rv_inner(heart);
  if (lv.distance(x) < 0) return Region::lv_blood;
  if (grown(lv, heart.wall_mm).distance(x) < 0) return Region::lv_myocardium;
  if (rv.distance(x) < 0) return Region::rv_blood;
  if (grown(rv, heart.rv_wall_mm).distance(x) < 0) return Region::rv_myocardium;
  return Region::none;
}

/// Unit fibre axis in world coordinates, helix +60 to -60 degrees; also defined a little outside the walls.
inline Vec3 fiber_of(const ModelHeart& heart, const Vec3& world_mm, bool mirrored = false) {
  const Vec3 x = heart.pose.to_heart(world_mm);
  const auto lv = lv_inner(heart), rv = rv_inner(heart);
  const double from_left = grown(lv, heart.wall_mm).distance(x);
  const bool left = from_left < 0 || from_left < std::max(grown(rv, heart.rv_wall_mm).distance(x), -rv.distance(x));
  const auto inner = left ? lv : rv;
  const auto outer = grown(inner, left ? heart.wall_mm : heart.rv_wall_mm);
  const double in = std::max(inner.distance(x), 0.0), out = std::max(-outer.distance(x), 0.0);
  const double depth = in + out > 0 ? in / (in + out) : 0.5;
  const Vec3 n = normalized((1 - depth) * inner.normal(x) + depth * outer.normal(x));
  const Vec3 up = normalized(Vec3{0, 0, 1} - n.z * n), around = cross(up, n);
  const double helix = (mirrored ? -1 : 1) * (60 - 120 * depth) * std::acos(-1.0) / 180;
  return heart.pose.rotation * (std::cos(helix) * around + std::sin(helix) * up);
}

/// Labels on a cube of `size_mm` around the heart.
inline LabelVolume labels_of(const ModelHeart& heart, double spacing_mm, double size_mm = 130) {
  Grid grid;
  const auto n = static_cast<std::int64_t>(size_mm / spacing_mm);
  grid.size = {n, n, n};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  const Vec3 middle = heart.pose.to_world({-10, 0, -18});
  grid.origin_mm = middle - 0.5 * size_mm * Vec3{1, 1, 1};
  LabelVolume labels(grid);
  for (std::int64_t k = 0; k < n; ++k)
    for (std::int64_t j = 0; j < n; ++j)
      for (std::int64_t i = 0; i < n; ++i)
        labels(i, j, k) = tag(region_of(
            heart, lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})));
  return labels;
}

/// Six tetrahedra per voxel of ventricular muscle; nodes are the voxels' corners.
inline TetMesh voxel_mesh(const LabelVolume& labels) {
  constexpr std::array<std::array<int, 4>, 6> split{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
  TetMesh mesh;
  std::map<Index3, std::int32_t> ids;
  const auto node = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const auto [entry, is_new] = ids.try_emplace(Index3{i, j, k}, static_cast<std::int32_t>(mesh.nodes_mm.size()));
    if (is_new)
      mesh.nodes_mm.push_back(lps_from_index(
          labels.grid, {static_cast<double>(i) - 0.5, static_cast<double>(j) - 0.5, static_cast<double>(k) - 0.5}));
    return entry->second;
  };
  for (std::int64_t k = 0; k < labels.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < labels.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < labels.grid.size[0]; ++i) {
        const auto label = labels(i, j, k);
        if (!is_myocardium(static_cast<Region>(label))) continue;
        std::array<std::int32_t, 8> corner;
        for (int c = 0; c < 8; ++c)
          corner[static_cast<std::size_t>(c)] = node(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2));
        for (const auto& t : split) {
          Cell cell;
          for (std::size_t v = 0; v < 4; ++v) cell[v] = corner[static_cast<std::size_t>(t[v])];
          if (cell_volume_mm3(mesh, cell) < 0) std::swap(cell[2], cell[3]);
          mesh.cells.push_back(cell);
          mesh.region.push_back(label);
        }
      }
  return mesh;
}

inline double axis_angle_deg(const Vec3& a, const Vec3& b) {
  return std::atan2(norm(cross(a, b)), std::abs(dot(a, b))) * 180 / std::acos(-1.0);
}

}  // namespace heartgen::testing
