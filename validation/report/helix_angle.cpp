// SPDX-License-Identifier: GPL-3.0-or-later
// Helix angles for colouring. The certificate's profile solves for the wall's depth; here the wall's normal is enough:
// the normals of the endocardium and the epicardium, averaged into the wall.
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "generator/parallel/tasks.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"
#include "validation/boundary_faces.hpp"
#include "validation/heart_frame.hpp"
#include "validation/report/pictures.hpp"

namespace heartgen::report {
namespace {

/// Neighbours of node n: list[start[n]] .. list[start[n + 1]], ascending.
struct Neighbours {
  std::vector<std::size_t> start;
  std::vector<std::int32_t> list;
};

Neighbours neighbours_within(const TetMesh& mesh, const std::vector<std::uint8_t>& chosen) {
  const auto nodes = mesh.nodes_mm.size();
  std::vector<std::size_t> start(nodes + 1, 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (chosen[c])
      for (const auto n : mesh.cells[c]) start[static_cast<std::size_t>(n) + 1] += 3;
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::int32_t> list(start.back());
  auto end = start;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (chosen[c])
      for (const auto a : mesh.cells[c])
        for (const auto b : mesh.cells[c])
          if (a != b) list[end[static_cast<std::size_t>(a)]++] = b;
  Neighbours result;
  result.start.assign(nodes + 1, 0);
  for (std::size_t n = 0; n < nodes; ++n) {
    const auto first = list.begin() + static_cast<std::ptrdiff_t>(start[n]);
    const auto last = list.begin() + static_cast<std::ptrdiff_t>(end[n]);
    std::sort(first, last);
    result.list.insert(result.list.end(), first, std::unique(first, last));
    result.start[n + 1] = result.list.size();
  }
  return result;
}

/// Sorted keys of the labelled faces with their surface tags.
std::vector<std::pair<Face, std::int32_t>> labelled_faces(const TetMesh& mesh) {
  std::vector<std::pair<Face, std::int32_t>> table;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    Face key = mesh.faces[f];
    std::sort(key.begin(), key.end());
    table.emplace_back(key, mesh.surface[f]);
  }
  std::sort(table.begin(), table.end());
  return table;
}

/// +1 where the wall's outward direction leaves the cells through a face of this surface, -1 where it enters, 0 where
/// the face says nothing about the wall (cuts, orifices).
double wall_side(std::int32_t surface, Region ventricle) {
  const std::string name = surface_name(surface);
  const bool left = ventricle == Region::lv_myocardium;
  if (name == "lv_endocardium") return left ? -1 : 0;
  if (name == "rv_endocardium") return left ? 1 : -1;
  return name == "epicardium" ? 1 : 0;
}

/// Unit outward wall direction at the nodes of the chosen cells: given on the wall's surfaces, averaged in between.
std::vector<Vec3> wall_normals(const TetMesh& mesh, const std::vector<validation::MeshFace>& faces,
                               const std::vector<std::uint8_t>& chosen, Region ventricle) {
  std::vector<Vec3> normals(mesh.nodes_mm.size());
  std::vector<std::uint8_t> fixed(mesh.nodes_mm.size(), 0);
  const auto labels = labelled_faces(mesh);
  for (const auto boundary = validation::boundary_faces(mesh, faces, chosen); const Face& face : boundary.faces) {
    Face key = face;
    std::sort(key.begin(), key.end());
    const auto at = std::lower_bound(labels.begin(), labels.end(), std::pair{key, INT32_MIN});
    const double side = at != labels.end() && at->first == key ? wall_side(at->second, ventricle) : 0;
    if (side == 0) continue;
    const Vec3& a = mesh.nodes_mm[static_cast<std::size_t>(face[0])];
    const Vec3 area = cross(mesh.nodes_mm[static_cast<std::size_t>(face[1])] - a,
                            mesh.nodes_mm[static_cast<std::size_t>(face[2])] - a);
    for (const auto n : face) {
      normals[static_cast<std::size_t>(n)] += side * area;
      fixed[static_cast<std::size_t>(n)] = 1;
    }
  }
  for (Vec3& n : normals) n = normalized(n);
  const Neighbours around = neighbours_within(mesh, chosen);
  constexpr int sweeps = 60;  // forth and back; walls are a few nodes thick
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t step = 0; step < normals.size(); ++step) {
      const std::size_t n = sweep % 2 ? normals.size() - 1 - step : step;
      if (fixed[n] || around.start[n] == around.start[n + 1]) continue;
      Vec3 sum;
      for (auto k = around.start[n]; k < around.start[n + 1]; ++k)
        sum += normals[static_cast<std::size_t>(around.list[k])];
      normals[n] = normalized(sum);
    }
  return normals;
}

double helix_deg(const Vec3& fiber, const Vec3& outward, const Vec3& axis) {
  const Vec3 along = normalized(axis - dot(axis, outward) * outward);
  const Vec3 around = cross(along, outward);
  double c = dot(fiber, around), l = dot(fiber, along);
  if (c * c + l * l < 1e-12) return std::numeric_limits<double>::quiet_NaN();
  if (c < 0) c = -c, l = -l;
  constexpr double degrees = 57.29577951308232;
  return math::atan2(l, c) * degrees;
}

/// The nodes of a ventricle's wall, and its unit outward direction there.
struct Wall {
  std::vector<std::uint8_t> used;
  std::vector<Vec3> normals;
};

Wall wall_of(const TetMesh& mesh, const std::vector<validation::MeshFace>& faces, Region ventricle) {
  Wall wall;
  wall.used.assign(mesh.nodes_mm.size(), 0);
  std::vector<std::uint8_t> chosen(mesh.cells.size(), 0);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    chosen[c] = mesh.region[c] == tag(ventricle);
    if (chosen[c])
      for (const auto n : mesh.cells[c]) wall.used[static_cast<std::size_t>(n)] = 1;
  }
  wall.normals = wall_normals(mesh, faces, chosen, ventricle);
  return wall;
}

}  // namespace

std::vector<double> helix_angle_per_node(const TetMesh& mesh) {
  return helix_angle_per_node(mesh, validation::mesh_faces(mesh));
}

std::vector<double> helix_angle_per_node(const TetMesh& mesh, const std::vector<validation::MeshFace>& faces) {
  std::vector<double> angles(mesh.nodes_mm.size(), std::numeric_limits<double>::quiet_NaN());
  if (mesh.node_fibers.fiber.size() != mesh.nodes_mm.size()) return angles;
  const Vec3 axis = validation::heart_frame(mesh).axis;
  std::array<Wall, 2> walls;
  parallel::run_tasks(
      std::array<std::function<void()>, 2>{[&] { walls[0] = wall_of(mesh, faces, Region::rv_myocardium); },
                                           [&] { walls[1] = wall_of(mesh, faces, Region::lv_myocardium); }});
  for (const auto& [used, normals] : walls)  // shared nodes: the left one's
    for (std::size_t n = 0; n < angles.size(); ++n) {
      const Vec3& fiber = mesh.node_fibers.fiber[n];
      if (used[n] && dot(normals[n], normals[n]) > 0.5 && dot(fiber, fiber) > 0.5)
        angles[n] = helix_deg(fiber, normals[n], axis);
    }
  return angles;
}

}  // namespace heartgen::report
