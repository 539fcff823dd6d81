// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The small analytic pair of ventricles as a mesh with everything that decks ask for: named surfaces and fibres.
#pragma once
#include "support/model_heart.hpp"
#include "support/two_region_mesh.hpp"

namespace heartgen::testing {

inline std::int32_t surface_of_heart(const ModelHeart& heart, const Vec3& at_mm, double spacing_mm) {
  const auto is_near = [&](const auto& cavity) { return cavity.distance(at_mm) < spacing_mm; };
  if (at_mm.z > heart.base_mm - spacing_mm) return *surface_from_name("base");
  if (is_near(lv_inner(heart))) return *surface_from_name("lv_endocardium");
  if (is_near(rv_inner(heart))) return *surface_from_name("rv_endocardium");
  return *surface_from_name("epicardium");
}

/// Ventricles of cubes of `spacing_mm`, cut into tetrahedra.
inline TetMesh fibred_heart(double spacing_mm) {
  const ModelHeart heart;
  TetMesh mesh = voxel_mesh(labels_of(heart, spacing_mm));
  label_faces(mesh);
  const auto outside = surface_between(Region::lv_myocardium, Region::none);
  const auto middle = [&](const auto& corners) {
    Vec3 sum;
    for (const auto node : corners) sum += mesh.nodes_mm[static_cast<std::size_t>(node)];
    return sum / static_cast<double>(corners.size());
  };
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (mesh.surface[f] == outside) mesh.surface[f] = surface_of_heart(heart, middle(mesh.faces[f]), spacing_mm);
  const auto append = [&](FiberField& field, const Vec3& at_mm) {
    const Vec3 fiber = normalized(fiber_of(heart, at_mm));
    const Vec3 other = std::abs(fiber.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    const Vec3 sheet = normalized(cross(fiber, other));
    field.fiber.push_back(fiber);
    field.sheet.push_back(sheet);
    field.sheet_normal.push_back(cross(fiber, sheet));
  };
  for (const auto& node : mesh.nodes_mm) append(mesh.node_fibers, node);
  for (const auto& cell : mesh.cells) append(mesh.cell_fibers, middle(cell));
  mesh.fiber_source.assign(mesh.nodes_mm.size(), static_cast<std::uint8_t>(FiberSource::rule));
  return mesh;
}

}  // namespace heartgen::testing
