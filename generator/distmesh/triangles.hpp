// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A triangle mesh of several materials that can be changed: triangles come and go, and every node knows its triangles.
/// The labels of the triangles are the truth about where materials are; a node `touches` the labels of its triangles,
/// the outside (bit 0) where the mesh ends, and the sides of the box on which it lies.
#pragma once
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "generator/distmesh/distmesh.hpp"
#include "generator/distmesh/nodes.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::distmesh {

struct Triangles {
  std::vector<Vec3> nodes_mm;
  std::vector<LabelBits> touches;               ///< per node
  std::vector<std::uint8_t> pinned;             ///< per node: 1 where it must stay
  std::vector<Face> corners;                    ///< counter-clockwise; first node -1: no triangle
  std::vector<std::uint8_t> label;              ///< per triangle
  std::vector<std::vector<std::int32_t>> star;  ///< per node: its triangles, in a repeatable order

  const Vec3& at(std::int32_t node) const { return nodes_mm[static_cast<std::size_t>(node)]; }
  LabelBits bits(std::int32_t node) const { return touches[static_cast<std::size_t>(node)]; }
  const Face& triangle(std::int32_t t) const { return corners[static_cast<std::size_t>(t)]; }
  bool is_alive(std::int32_t t) const { return triangle(t)[0] >= 0; }
  int label_of(std::int32_t t) const { return label[static_cast<std::size_t>(t)]; }
};

/// Sine of the least angle: twice the area over the two longer sides; negative for clockwise triangles.
inline double min_sine(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, bc = c - b;
  const double p = dot(ab, ab), q = dot(ac, ac), r = dot(bc, bc);
  const double longer = p * q * r / std::min({p, q, r});
  return longer > 0 ? (ab.x * ac.y - ab.y * ac.x) / std::sqrt(longer) : 0;
}
double quality(const Triangles& mesh, std::int32_t triangle);

/// The labelled triangles of a truss in two dimensions.
Triangles triangles_of(const Truss& truss);

std::int32_t add_triangle(Triangles& mesh, const Face& corners, int label);
void remove_triangle(Triangles& mesh, std::int32_t triangle);

/// Undoes remove_triangle: the same id, and the label it had.
void restore_triangle(Triangles& mesh, std::int32_t triangle, const Face& corners);

/// The triangles at the edge of two nodes: at most two, -1 where there is none.
std::array<std::int32_t, 2> triangles_at(const Triangles& mesh, std::int32_t a, std::int32_t b);

/// Whether two labels meet at an edge, or the mesh ends there.
bool is_interface(const Triangles& mesh, std::int32_t a, std::int32_t b);

/// Finds anew what a node touches; a node on a side of the box stays on it.
void update_touches(Triangles& mesh, std::int32_t node);

/// Nodes that share a triangle with `node`, ascending.
std::vector<std::int32_t> neighbours(const Triangles& mesh, std::int32_t node);

/// Drops free slots and nodes without triangles; triangles ascending, smallest node first.
void compress(Triangles& mesh);

}  // namespace heartgen::distmesh
