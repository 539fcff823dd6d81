// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/wall_depth.hpp"

#include <algorithm>
#include <limits>

#include "model/mesh_queries/mesh_laplace.hpp"

namespace heartgen::validation {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Per node of the mesh: 0 or 1 on the two surfaces, `unknown` elsewhere; the endocardium wins at their common rim.
std::vector<double> fixed_depths(const TetMesh& mesh, Region ventricle) {
  const bool left = ventricle == Region::lv_myocardium;
  const auto inner = *surface_from_name(left ? "lv_endocardium" : "rv_endocardium");
  const auto base = *surface_from_name("papillary_base");
  const auto outer = *surface_from_name("epicardium");
  const auto septal = left ? *surface_from_name("rv_endocardium") : outer;
  std::vector<double> fixed(mesh.nodes_mm.size(), unknown);
  const auto set = [&](double depth, auto chosen) {
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
      if (chosen(mesh.surface[f]))
        for (const auto n : mesh.faces[f]) fixed[static_cast<std::size_t>(n)] = depth;
  };
  set(1, [&](std::int32_t s) { return s == outer || s == septal; });
  set(0, [&](std::int32_t s) { return s == inner || s == base; });
  return fixed;
}

}  // namespace

WallDepth wall_depth(const TetMesh& mesh, Region ventricle) {
  WallDepth wall;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(ventricle)) wall.cells.push_back(static_cast<std::int32_t>(c));
  const mesh_queries::Stiffness matrix = mesh_queries::make_stiffness(mesh, wall.cells);
  const auto of_nodes = fixed_depths(mesh, ventricle);
  mesh_queries::FixedValues fixed;
  for (const auto n : matrix.nodes) fixed.push_back(of_nodes[static_cast<std::size_t>(n)]);
  const auto holds = [&](double value) { return std::find(fixed.begin(), fixed.end(), value) != fixed.end(); };
  if (!holds(0) || !holds(1)) return {};
  const auto depth = mesh_queries::solve_laplace(matrix, fixed);
  for (std::size_t c = 0; c < wall.cells.size(); ++c) {
    const auto gradient = mesh_queries::shape_gradients(mesh, mesh.cells[static_cast<std::size_t>(wall.cells[c])]);
    double mean = 0;
    Vec3 slope;
    for (std::size_t n = 0; n < 4; ++n) {
      const double at = depth[static_cast<std::size_t>(matrix.corners[c][n])];
      mean += 0.25 * at;
      slope += at * gradient[n];
    }
    wall.depth.push_back(mean);
    wall.normal.push_back(normalized(slope));
  }
  return wall;
}

}  // namespace heartgen::validation
