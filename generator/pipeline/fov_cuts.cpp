// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/fov_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "generator/mesh/surfaces.hpp"
#include "model/labels.hpp"

namespace heartgen::pipeline {
namespace {

/// A face of the outer surface.
struct OuterFace {
  Vec3 center_mm, normal;  ///< the normal points out of the body
  double edge_mm = 0;      ///< the longest
};

Face ascending(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

/// The outer faces for which `is_cut` is true get the surface fov_cut.
template <class IsCut>
void label_cuts(TetMesh& mesh, IsCut is_cut) {
  std::vector<Face> outer;
  for (const auto& face : mesh::cell_faces(mesh.cells))
    if (face.other < 0) outer.push_back(ascending(face.nodes));
  std::sort(outer.begin(), outer.end());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (!std::binary_search(outer.begin(), outer.end(), ascending(mesh.faces[f]))) continue;
    const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(mesh.faces[f][i])]; };
    const OuterFace face{(at(0) + at(1) + at(2)) / 3, normalized(cross(at(1) - at(0), at(2) - at(0))),
                         std::max({norm(at(1) - at(0)), norm(at(2) - at(1)), norm(at(0) - at(2))})};
    if (is_cut(face)) mesh.surface[f] = *surface_from_name("fov_cut");
  }
}

}  // namespace

void label_torso_cuts(TetMesh& mesh, const Grid& torso_grid) {
  constexpr double near_voxels = 1, min_cosine = 0.9;
  const Mat3 axes = transposed(torso_grid.direction);
  label_cuts(mesh, [&](const OuterFace& face) {
    const Vec3 index = index_from_lps(torso_grid, face.center_mm), normal = axes * face.normal;
    for (int axis = 0; axis < 3; ++axis) {
      const double last = static_cast<double>(torso_grid.size[static_cast<std::size_t>(axis)]) - 0.5;
      if (std::abs(index[axis] + 0.5) < near_voxels && normal[axis] < -min_cosine) return true;
      if (std::abs(index[axis] - last) < near_voxels && normal[axis] > min_cosine) return true;
    }
    return false;
  });
}

void label_padding_cuts(TetMesh& mesh, const Grid& grid, const anatomy::Padding& padding) {
  constexpr double near_voxels = 1.5, near_edges = 0.35;  // smoothed and coarse, the mesh cuts the padding's corners
  if (!padding.is_there()) return;
  const double voxel_mm = std::max({grid.spacing_mm.x, grid.spacing_mm.y, grid.spacing_mm.z});
  label_cuts(mesh, [&](const OuterFace& face) {
    const double reach_mm = std::max(near_voxels * voxel_mm, near_edges * face.edge_mm);
    const int steps = static_cast<int>(std::ceil(2 * reach_mm / voxel_mm));
    for (int n = 1; n <= steps; ++n) {
      const Vec3 at = index_from_lps(grid, face.center_mm + (n * reach_mm / steps) * face.normal);
      const Index3 voxel{std::llround(at.x), std::llround(at.y), std::llround(at.z)};
      if (grid.contains(voxel[0], voxel[1], voxel[2]) && padding.covers(voxel)) return true;
    }
    return false;
  });
}

}  // namespace heartgen::pipeline
