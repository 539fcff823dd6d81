// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A tree of boxes over triangles: which are near a point or in a box, in logarithmic time. Positions in mm.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh_queries {

using Triangle = std::array<Vec3, 3>;

struct FaceTree {
  /// A box around the triangles order[begin] to order[end - 1]; its first child follows it, the second is at `second`.
  struct Node {
    Vec3 low_mm, high_mm;
    std::int32_t begin = 0, end = 0;
    std::int32_t second = -1;  ///< -1: a leaf
  };
  std::vector<Triangle> triangles_mm;  ///< as given
  std::vector<std::int32_t> order;     ///< ids of triangles
  std::vector<Node> nodes;             ///< the root first; empty without triangles
};

FaceTree make_face_tree(std::vector<Triangle> triangles_mm);
FaceTree make_face_tree(const std::vector<Vec3>& nodes_mm, const std::vector<Face>& faces);

struct NearestFace {
  std::int32_t face = -1;  ///< -1: none
  Vec3 point_mm;           ///< of the triangle
  double distance_mm = 0;
};

/// The triangle nearest to a point among those that `accept` takes (all, without it), the one of the smallest id where
/// several are equally near; none farther away than `reach_mm`.
NearestFace nearest_face(const FaceTree& tree, const Vec3& point_mm, double reach_mm,
                         const std::function<bool(std::int32_t)>& accept = {});

/// Appends the ids of the triangles whose boxes meet the box, in the tree's order.
void faces_in_box(const FaceTree& tree, const Vec3& low_mm, const Vec3& high_mm, std::vector<std::int32_t>& faces);

/// The point of a triangle nearest to `point`.
Vec3 nearest_on_triangle(const Triangle& triangle, const Vec3& point);

}  // namespace heartgen::mesh_queries
