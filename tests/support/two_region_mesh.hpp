// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A small labelled mesh with everything a bundle can hold: two regions, outer surfaces and their interface, rims,
/// fibres on nodes and cells, parent ids.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "model/labels.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::testing {

/// Orthonormal axes that turn along z, as fibres do through a wall.
inline void append_axes(FiberField& field, const Vec3& at_mm) {
  const double angle = 0.2 * at_mm.z + 0.03 * at_mm.x;
  const Vec3 fiber{std::cos(angle), std::sin(angle), 0}, sheet{0, 0, 1};
  field.fiber.push_back(fiber);
  field.sheet.push_back(sheet);
  field.sheet_normal.push_back(cross(fiber, sheet));
}

/// Faces with one cell, or between two regions, labelled by the regions they separate.
inline void label_faces(TetMesh& mesh) {
  std::map<Face, std::vector<std::size_t>> cells_of;  // sorted node ids
  std::map<Face, Face> oriented;
  constexpr int corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto& corner : corners) {
      Face face;
      for (std::size_t i = 0; i < 3; ++i) face[i] = mesh.cells[c][static_cast<std::size_t>(corner[i])];
      Face key = face;
      std::sort(key.begin(), key.end());
      cells_of[key].push_back(c);
      oriented.emplace(key, face);
    }
  for (const auto& [key, cells] : cells_of) {
    const auto first = mesh.region[cells[0]];
    const auto second = cells.size() == 2 ? mesh.region[cells[1]] : 0;
    if (first == second) continue;
    mesh.faces.push_back(oriented[key]);
    mesh.surface.push_back(surface_between(static_cast<Region>(first), static_cast<Region>(second)));
  }
}

/// The nodes that a surface shares with others.
inline void add_rim(TetMesh& mesh, std::int32_t surface_tag) {
  std::set<std::int32_t> own, other, common;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    (mesh.surface[f] == surface_tag ? own : other).insert(mesh.faces[f].begin(), mesh.faces[f].end());
  std::set_intersection(own.begin(), own.end(), other.begin(), other.end(), std::inserter(common, common.end()));
  mesh.rims.push_back({surface_name(surface_tag) + "_rim", 1000 + surface_tag, {common.begin(), common.end()}});
}

/// A block of 2n × n × n cubes of six tetrahedra each: LV muscle in the half of small x, `other` in the other.
inline TetMesh two_region_mesh(int n, Region other = Region::lv_blood) {
  TetMesh mesh;
  const auto id = [n](int i, int j, int k) { return (k * (n + 1) + j) * (2 * n + 1) + i; };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= 2 * n; ++i) mesh.nodes_mm.push_back({1.0 / 3 + 1.1 * i, -7.25 + j, 0.9 * k});
  constexpr int paths[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};  // corners between 0 and 7
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < 2 * n; ++i)
        for (const auto& path : paths) {
          const auto corner = [&](int bits) { return id(i + (bits & 1), j + ((bits >> 1) & 1), k + (bits >> 2)); };
          mesh.cells.push_back({corner(0), corner(path[0]), corner(path[1]), corner(7)});
          if (cell_volume_mm3(mesh, mesh.cells.back()) < 0) std::swap(mesh.cells.back()[1], mesh.cells.back()[2]);
          mesh.region.push_back(tag(i < n ? Region::lv_myocardium : other));
        }
  label_faces(mesh);
  std::set<std::int32_t> tags(mesh.surface.begin(), mesh.surface.end());
  for (const auto surface : tags) add_rim(mesh, surface);
  for (const auto& node : mesh.nodes_mm) {
    append_axes(mesh.node_fibers, node);
    mesh.fiber_source.push_back(static_cast<std::uint8_t>(mesh.fiber_source.size() % 4));
    mesh.parent_node.push_back(static_cast<std::int32_t>(mesh.parent_node.size()) + 1000);
  }
  for (const auto& cell : mesh.cells) {
    append_axes(mesh.cell_fibers, mesh.nodes_mm[static_cast<std::size_t>(cell[0])]);
    mesh.rule_difference_deg.push_back(static_cast<float>(mesh.rule_difference_deg.size() % 90));
    mesh.parent_cell.push_back(static_cast<std::int32_t>(mesh.parent_cell.size()) + 5000);
  }
  return mesh;
}

}  // namespace heartgen::testing
