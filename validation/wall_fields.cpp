// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/wall_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "model/mesh_queries/face_tree.hpp"
#include "validation/cell_quality.hpp"
#include "validation/quantiles.hpp"

namespace heartgen::validation {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// The region of muscle behind each listed face: the one whose own endocardium or outside this is.
struct Sides {
  Region wall;
  std::int32_t inside;
};

const std::array<Sides, 4>& walls_of_heart() {
  static const std::array<Sides, 4> all = {{{Region::lv_myocardium, *surface_from_name("lv_endocardium")},
                                            {Region::rv_myocardium, *surface_from_name("rv_endocardium")},
                                            {Region::la_wall, *surface_from_name("la_endocardium")},
                                            {Region::ra_wall, *surface_from_name("ra_endocardium")}}};
  return all;
}

/// Whether a wall may end there: at its outside, or at the blood of another chamber.
bool ends_walls(std::int32_t surface) {
  static const std::vector<std::int32_t> names = [] {
    std::vector<std::int32_t> tags;
    for (const char* name : {"epicardium", "lv_endocardium", "rv_endocardium", "la_endocardium", "ra_endocardium",
                             "lung_surface", "liver_surface", "aorta_wall", "pulmonary_artery_wall"})
      tags.push_back(*surface_from_name(name));
    return tags;
  }();
  return std::find(names.begin(), names.end(), surface) != names.end();
}

std::vector<Face> faces_with(const TetMesh& mesh, auto wanted) {
  std::vector<Face> faces;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (wanted(mesh.surface[f])) faces.push_back(mesh.faces[f]);
  return faces;
}

void add_thickness(const TetMesh& mesh, const Sides& sides, std::vector<double>& thickness_mm) {
  constexpr double reach_mm = 30;
  const mesh_queries::FaceTree inside =
      mesh_queries::make_face_tree(mesh.nodes_mm, faces_with(mesh, [&](auto s) { return s == sides.inside; }));
  const mesh_queries::FaceTree outside = mesh_queries::make_face_tree(
      mesh.nodes_mm, faces_with(mesh, [&](auto s) { return s != sides.inside && ends_walls(s); }));
  if (inside.nodes.empty() || outside.nodes.empty()) return;
  std::vector<std::size_t> nodes;
  std::vector<std::uint8_t> taken(mesh.nodes_mm.size(), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(sides.wall))
      for (const auto n : mesh.cells[c])
        if (!std::exchange(taken[static_cast<std::size_t>(n)], 1)) nodes.push_back(static_cast<std::size_t>(n));
  parallel::parallel_for(0, static_cast<std::int64_t>(nodes.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i) {
      const std::size_t n = nodes[static_cast<std::size_t>(i)];
      const auto in = mesh_queries::nearest_face(inside, mesh.nodes_mm[n], reach_mm);
      const auto out = mesh_queries::nearest_face(outside, mesh.nodes_mm[n], reach_mm);
      if (in.face >= 0 && out.face >= 0) thickness_mm[n] = in.distance_mm + out.distance_mm;
    }
  });
}

WallField thickness_field(const TetMesh& mesh) {
  WallField field{"thickness", "wall thickness", "mm", 0, 1, std::vector<double>(mesh.nodes_mm.size(), unknown), {}};
  for (const Sides& sides : walls_of_heart()) add_thickness(mesh, sides, field.values);
  std::vector<double> known;
  for (const double v : field.values)
    if (std::isfinite(v)) known.push_back(v);
  field.high = std::max(2.0, std::ceil(quantile(std::move(known), 0.98)));
  return field;
}

/// Per node: the cells' values joined, from `first` on; NaN where no cell has one.
template <class Value, class Join>
std::vector<double> node_values(const TetMesh& mesh, Value value_of_cell, Join join) {
  std::vector<double> values(mesh.nodes_mm.size(), unknown);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const double value = value_of_cell(c);
    if (!std::isfinite(value)) continue;
    for (const auto n : mesh.cells[c]) {
      double& at = values[static_cast<std::size_t>(n)];
      at = std::isfinite(at) ? join(at, value) : value;
    }
  }
  return values;
}

WallField source_field(const TetMesh& mesh) {
  WallField field{"source", "where fibres come from", "", 0, 3, {}, {"none", "atlas", "filled in", "rule"}};
  field.values.assign(mesh.fiber_source.begin(), mesh.fiber_source.end());
  return field;
}

WallField difference_field(const TetMesh& mesh) {
  WallField field{"difference", "angle to rule-based fibres", "\u00B0", 0, 60, {}, {}};
  const auto of_cell = [&](std::size_t c) {
    return mesh.rule_difference_deg[c] >= 0 ? static_cast<double>(mesh.rule_difference_deg[c]) : unknown;
  };
  field.values = node_values(mesh, of_cell, [](double a, double b) { return std::max(a, b); });
  return field;
}

WallField quality_field(const TetMesh& mesh) {
  const auto of_cell = [&](std::size_t c) { return min_dihedral_deg(mesh, c); };
  WallField field{"quality", "smallest dihedral angle of a cell", "\u00B0", 0, 70, {}, {}};
  field.values = node_values(mesh, of_cell, [](double a, double b) { return std::min(a, b); });
  return field;
}

}  // namespace

std::uint8_t byte_of(const WallField& field, double value) {
  if (!std::isfinite(value)) return 0;
  if (!field.categories.empty()) return static_cast<std::uint8_t>(1 + std::lround(value));
  const double share = std::clamp((value - field.low) / (field.high - field.low), 0.0, 1.0);
  return static_cast<std::uint8_t>(1 + std::lround(254 * share));
}

std::vector<WallField> wall_fields(const TetMesh& walls, const std::vector<double>& helix_deg) {
  std::vector<WallField> fields;
  if (std::any_of(helix_deg.begin(), helix_deg.end(), [](double v) { return std::isfinite(v); }))
    fields.push_back({"helix", "helix angle of the fibres", "\u00B0", -90, 90, helix_deg, {}});
  fields.push_back(thickness_field(walls));
  if (walls.fiber_source.size() == walls.nodes_mm.size()) fields.push_back(source_field(walls));
  if (walls.rule_difference_deg.size() == walls.cells.size()) fields.push_back(difference_field(walls));
  fields.push_back(quality_field(walls));
  return fields;
}

double min_dihedral_deg(const TetMesh& mesh, std::size_t cell) {
  std::array<Vec3, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.nodes_mm[static_cast<std::size_t>(mesh.cells[cell][k])];
  return cell_quality(corners).min_dihedral_deg;
}

}  // namespace heartgen::validation
