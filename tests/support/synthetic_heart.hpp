// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A small heart for pictures: two ventricles as half ellipsoids cut flat at the base, blood inside, tetrahedra from
/// voxels (six per voxel), and fibres that turn from +60 degrees inside to -60 outside.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>

#include "model/labels.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "tests/support/two_region_mesh.hpp"

namespace heartgen::testing {

inline double ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
  const Vec3 d = p - center;
  return std::sqrt(d.x * d.x / (radii.x * radii.x) + d.y * d.y / (radii.y * radii.y) + d.z * d.z / (radii.z * radii.z));
}

inline Region synthetic_region(const Vec3& p) {
  if (p.z > 20) return Region::none;
  if (ellipsoid(p, {0, 0, 20}, {20, 20, 50}) < 1) return Region::lv_blood;
  if (ellipsoid(p, {0, 0, 20}, {30, 30, 60}) < 1) return Region::lv_myocardium;
  if (ellipsoid(p, {-16, -8, 20}, {36, 32, 46}) < 1) return Region::rv_blood;
  if (ellipsoid(p, {-16, -8, 20}, {40, 36, 50}) < 1) return Region::rv_myocardium;
  return Region::none;
}

/// A cube of (110 mm)^3 around the heart; blood 300 HU, muscle 100 HU, -80 HU outside.
inline LabelVolume synthetic_labels(double spacing_mm) {
  Grid grid;
  const auto n = static_cast<std::int64_t>(110 / spacing_mm);
  grid.size = {n, n, n};
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  grid.origin_mm = {-68, -55, -50};
  LabelVolume labels(grid);
  for (std::int64_t k = 0; k < n; ++k)
    for (std::int64_t j = 0; j < n; ++j)
      for (std::int64_t i = 0; i < n; ++i)
        labels(i, j, k) = tag(synthetic_region(lps_from_index(grid, {double(i), double(j), double(k)})));
  return labels;
}

inline CtVolume synthetic_ct(const LabelVolume& labels) {
  CtVolume ct(labels.grid, -80);
  for (std::size_t v = 0; v < ct.voxels.size(); ++v) {
    const auto region = static_cast<Region>(labels.voxels[v]);
    const int noise = static_cast<int>((v * 2654435761u >> 7) % 41) - 20;
    ct.voxels[v] = static_cast<std::int16_t>((is_blood(region) ? 300 : is_myocardium(region) ? 100 : -80) + noise);
  }
  return ct;
}

/// Helix angle +60 to -60 by the depth between the two ellipsoids of the LV, in the frame of the z axis.
inline Vec3 synthetic_fiber(const Vec3& p) {
  const double inner = ellipsoid(p, {0, 0, 20}, {20, 20, 50}), outer = ellipsoid(p, {0, 0, 20}, {30, 30, 60});
  const double depth = std::clamp((inner - 1) / std::max(1e-6, (inner - 1) + (1 - outer)), 0.0, 1.0);
  const double helix = (60 - 120 * depth) * 3.14159265358979 / 180;
  const Vec3 around = normalized(Vec3{-p.y, p.x, 1e-9});
  return std::cos(helix) * around + std::sin(helix) * Vec3{0, 0, 1};
}

/// Tetrahedra of the voxels whose region passes `keep`; shared nodes, labelled faces, fibres on the nodes.
template <class Keep>
TetMesh voxel_mesh(const LabelVolume& labels, Keep keep) {
  TetMesh mesh;
  std::map<Index3, std::int32_t> ids;
  const auto node = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const auto [at, fresh] = ids.try_emplace({k, j, i}, static_cast<std::int32_t>(mesh.nodes_mm.size()));
    if (fresh) mesh.nodes_mm.push_back(lps_from_index(labels.grid, {i - 0.5, j - 0.5, k - 0.5}));
    return at->second;
  };
  constexpr int paths[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};
  const auto& size = labels.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i) {
        if (!keep(static_cast<Region>(labels(i, j, k)))) continue;
        for (const auto& path : paths) {
          const auto corner = [&](int bits) { return node(i + (bits & 1), j + ((bits >> 1) & 1), k + (bits >> 2)); };
          mesh.cells.push_back({corner(0), corner(path[0]), corner(path[1]), corner(7)});
          if (cell_volume_mm3(mesh, mesh.cells.back()) < 0) std::swap(mesh.cells.back()[1], mesh.cells.back()[2]);
          mesh.region.push_back(labels(i, j, k));
        }
      }
  label_faces(mesh);
  return mesh;
}

/// Labels that a mesh of the walls alone needs: the face's surface follows from the blood next to it.
inline void label_endocardium(TetMesh& mesh) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    Vec3 c;
    for (const auto n : mesh.faces[f]) c += mesh.nodes_mm[static_cast<std::size_t>(n)] / 3;
    const char* name = "epicardium";
    if (c.z > 19)
      name = "mitral_orifice";
    else if (ellipsoid(c, {0, 0, 20}, {22.5, 22.5, 52.5}) < 1)
      name = "lv_endocardium";
    else if (ellipsoid(c, {-16, -8, 20}, {38, 34, 48}) < 1)
      name = "rv_endocardium";
    mesh.surface[f] = *surface_from_name(name);
  }
}

inline TetMesh synthetic_myocardium(const LabelVolume& labels) {
  TetMesh mesh = voxel_mesh(labels, [](Region r) { return is_myocardium(r); });
  label_endocardium(mesh);
  for (const Vec3& p : mesh.nodes_mm) {
    const Vec3 fiber = synthetic_fiber(p), radial = normalized(Vec3{p.x, p.y, 1e-9});
    mesh.node_fibers.fiber.push_back(fiber);
    mesh.node_fibers.sheet.push_back(radial);
    mesh.node_fibers.sheet_normal.push_back(cross(fiber, radial));
    mesh.fiber_source.push_back(static_cast<std::uint8_t>(FiberSource::atlas));
  }
  return mesh;
}

}  // namespace heartgen::testing
