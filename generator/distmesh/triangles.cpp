// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/triangles.hpp"

#include <algorithm>

#include "model/sort_unique.hpp"

namespace heartgen::distmesh {

double quality(const Triangles& mesh, std::int32_t triangle) {
  const auto& t = mesh.triangle(triangle);
  return min_sine(mesh.at(t[0]), mesh.at(t[1]), mesh.at(t[2]));
}

std::int32_t add_triangle(Triangles& mesh, const Face& corners, int label) {
  const auto id = static_cast<std::int32_t>(mesh.corners.size());
  mesh.corners.push_back(corners);
  mesh.label.push_back(static_cast<std::uint8_t>(label));
  for (const auto n : corners) mesh.star[static_cast<std::size_t>(n)].push_back(id);
  return id;
}

void remove_triangle(Triangles& mesh, std::int32_t triangle) {
  auto& corners = mesh.corners[static_cast<std::size_t>(triangle)];
  for (const auto n : corners) std::erase(mesh.star[static_cast<std::size_t>(n)], triangle);
  corners[0] = -1;
}

void restore_triangle(Triangles& mesh, std::int32_t triangle, const Face& corners) {
  mesh.corners[static_cast<std::size_t>(triangle)] = corners;
  for (const auto n : corners) mesh.star[static_cast<std::size_t>(n)].push_back(triangle);
}

std::array<std::int32_t, 2> triangles_at(const Triangles& mesh, std::int32_t a, std::int32_t b) {
  std::array<std::int32_t, 2> found{-1, -1};
  std::size_t count = 0;
  for (const auto t : mesh.star[static_cast<std::size_t>(a)]) {
    const auto& corners = mesh.triangle(t);
    if (std::find(corners.begin(), corners.end(), b) != corners.end() && count < 2) found[count++] = t;
  }
  return found;
}

bool is_interface(const Triangles& mesh, std::int32_t a, std::int32_t b) {
  const auto [t, u] = triangles_at(mesh, a, b);
  return t >= 0 && (u < 0 || mesh.label_of(t) != mesh.label_of(u));
}

void update_touches(Triangles& mesh, std::int32_t node) {
  auto& bits = mesh.touches[static_cast<std::size_t>(node)];
  const LabelBits sides = bits & tetmesh::side_bits;
  bits = sides;
  for (const auto t : mesh.star[static_cast<std::size_t>(node)]) {
    bits |= bit_of(mesh.label_of(t));
    for (const auto other : mesh.triangle(t))
      if (other != node && triangles_at(mesh, node, other)[1] < 0 && (mesh.bits(other) & sides) == 0) bits |= bit_of(0);
  }
}

std::vector<std::int32_t> neighbours(const Triangles& mesh, std::int32_t node) {
  std::vector<std::int32_t> result;
  for (const auto t : mesh.star[static_cast<std::size_t>(node)])
    for (const auto n : mesh.triangle(t))
      if (n != node) result.push_back(n);
  sort_unique(result);
  return result;
}

Triangles triangles_of(const Truss& truss) {
  Triangles mesh;
  mesh.nodes_mm = truss.nodes.at_mm;
  mesh.touches = truss.nodes.touches;
  mesh.pinned.assign(truss.nodes.size(), 0);
  std::fill_n(mesh.pinned.begin(), truss.nodes.fixed, std::uint8_t{1});
  mesh.star.resize(truss.nodes.size());
  for (std::size_t t = 0; t < truss.simplices.cells.size(); ++t) {
    const auto& cell = truss.simplices.cells[t];
    if (truss.label[t] != 0) add_triangle(mesh, {cell[0], cell[1], cell[2]}, truss.label[t]);
  }
  for (std::size_t n = 0; n < mesh.star.size(); ++n) update_touches(mesh, static_cast<std::int32_t>(n));
  return mesh;
}

void compress(Triangles& mesh) {
  Triangles result;
  std::vector<std::int32_t> id(mesh.nodes_mm.size(), -1);
  for (std::size_t n = 0; n < id.size(); ++n) {
    if (mesh.star[n].empty()) continue;
    id[n] = static_cast<std::int32_t>(result.nodes_mm.size());
    result.nodes_mm.push_back(mesh.nodes_mm[n]);
    result.touches.push_back(mesh.touches[n]);
    result.pinned.push_back(mesh.pinned[n]);
  }
  std::vector<std::pair<Face, std::uint8_t>> sorted;
  for (std::size_t t = 0; t < mesh.corners.size(); ++t) {
    Face corners = mesh.corners[t];
    if (corners[0] < 0) continue;
    for (auto& n : corners) n = id[static_cast<std::size_t>(n)];
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    sorted.emplace_back(corners, mesh.label[t]);
  }
  std::sort(sorted.begin(), sorted.end());
  result.star.resize(result.nodes_mm.size());
  for (const auto& [corners, label] : sorted) add_triangle(result, corners, label);
  mesh = std::move(result);
}

}  // namespace heartgen::distmesh
