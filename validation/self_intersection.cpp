// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/self_intersection.hpp"

#include <algorithm>
#include <array>

#include "generator/parallel/threads.hpp"
#include "model/mesh_queries/face_tree.hpp"
#include "validation/exact_orientation.hpp"

namespace heartgen::validation {
namespace {

/// An axis along which the triangle has an area; -1 where it has none at all.
int open_axis(const mesh_queries::Triangle& t) {
  for (int axis = 0; axis < 3; ++axis)
    if (orientation_along(axis, t[0], t[1], t[2]) != 0) return axis;
  return -1;
}

bool ranges_meet(double a, double b, double c, double d) {
  return std::min(a, b) <= std::max(c, d) && std::min(c, d) <= std::max(a, b);
}

/// Whether two segments of one plane meet.
bool segments_meet(int axis, const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  const int a = orientation_along(axis, p, q, r), b = orientation_along(axis, p, q, s);
  const int c = orientation_along(axis, r, s, p), d = orientation_along(axis, r, s, q);
  if (a == 0 && b == 0 && c == 0 && d == 0) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    return ranges_meet(p[i], q[i], r[i], s[i]) && ranges_meet(p[j], q[j], r[j], s[j]);
  }
  return a * b <= 0 && c * d <= 0;
}

bool is_inside(int axis, const mesh_queries::Triangle& t, const Vec3& p) {
  bool left = false, right = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const int side = orientation_along(axis, t[i], t[(i + 1) % 3], p);
    left |= side > 0;
    right |= side < 0;
  }
  return !(left && right);
}

bool meet_in_plane(const Vec3& p, const Vec3& q, const mesh_queries::Triangle& t) {
  const int axis = open_axis(t);
  if (axis < 0) return false;
  if (is_inside(axis, t, p) || is_inside(axis, t, q)) return true;
  for (std::size_t i = 0; i < 3; ++i)
    if (segments_meet(axis, p, q, t[i], t[(i + 1) % 3])) return true;
  return false;
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const mesh_queries::Triangle& t) {
  const int at_p = orientation(t[0], t[1], t[2], p), at_q = orientation(t[0], t[1], t[2], q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) return meet_in_plane(p, q, t);
  bool left = false, right = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const int side = orientation(p, q, t[i], t[(i + 1) % 3]);
    left |= side > 0;
    right |= side < 0;
  }
  return !(left && right);
}

bool all_on_one_side(const mesh_queries::Triangle& of, const mesh_queries::Triangle& t) {
  const int first = orientation(of[0], of[1], of[2], t[0]);
  return first != 0 && orientation(of[0], of[1], of[2], t[1]) == first &&
         orientation(of[0], of[1], of[2], t[2]) == first;
}

bool meet_apart(const mesh_queries::Triangle& a, const mesh_queries::Triangle& b) {
  if (all_on_one_side(a, b) || all_on_one_side(b, a)) return false;
  for (std::size_t i = 0; i < 3; ++i)
    if (segment_meets_triangle(a[i], a[(i + 1) % 3], b) || segment_meets_triangle(b[i], b[(i + 1) % 3], a)) return true;
  return false;
}

/// The triangles share corner 0 of each: whatever else they share reaches the opposite edge of one of them.
bool meet_at_corner(const mesh_queries::Triangle& a, const mesh_queries::Triangle& b) {
  const int one = orientation(a[0], a[1], a[2], b[1]), two = orientation(a[0], a[1], a[2], b[2]);
  if (one * two > 0) return false;
  return segment_meets_triangle(a[1], a[2], b) || segment_meets_triangle(b[1], b[2], a);
}

/// The triangles share corners 0 and 1 of each: they overlap only if they are folded onto each other.
bool folded(const mesh_queries::Triangle& a, const mesh_queries::Triangle& b) {
  const Vec3 edge = a[1] - a[0];
  const Vec3 u = cross(edge, a[2] - a[0]), v = cross(edge, b[2] - a[0]);
  if (dot(u, v) < 0) return false;  // more than a right angle apart
  if (orientation(a[0], a[1], a[2], b[2]) != 0) return false;
  const int axis = open_axis(a);
  return axis >= 0 && orientation_along(axis, a[0], a[1], a[2]) == orientation_along(axis, a[0], a[1], b[2]);
}

/// Both faces with their common nodes first, in the same order; the number of these.
std::size_t align(Face& a, Face& b) {
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = std::find(b.begin() + static_cast<std::ptrdiff_t>(shared), b.end(), a[i]);
    if (found == b.end()) continue;
    std::swap(*found, b[shared]);
    std::swap(a[i], a[shared++]);
  }
  return shared;
}

mesh_queries::Triangle corners(const std::vector<Vec3>& nodes, const Face& face) {
  return {nodes[static_cast<std::size_t>(face[0])], nodes[static_cast<std::size_t>(face[1])],
          nodes[static_cast<std::size_t>(face[2])]};
}

bool intersect(const std::vector<Vec3>& nodes, Face a, Face b) {
  const auto shared = align(a, b);
  const mesh_queries::Triangle s = corners(nodes, a), t = corners(nodes, b);
  if (shared == 0) return meet_apart(s, t);
  if (shared == 1) return meet_at_corner(s, t);
  return shared == 2 && folded(s, t);
}

}  // namespace

std::vector<std::pair<std::int32_t, std::int32_t>> intersecting_faces(const std::vector<Vec3>& nodes_mm,
                                                                      const std::vector<Face>& faces) {
  const auto tree = mesh_queries::make_face_tree(nodes_mm, faces);
  std::vector<std::vector<std::int32_t>> partners(faces.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::int32_t> near;
    for (auto f = begin; f < end; ++f) {
      const auto at = static_cast<std::size_t>(f);
      const auto& t = tree.triangles_mm[at];
      Vec3 low = t[0], high = t[0];
      for (const Vec3& p : t)
        for (int axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], p[axis]);
          high[axis] = std::max(high[axis], p[axis]);
        }
      near.clear();
      mesh_queries::faces_in_box(tree, low, high, near);
      for (const auto other : near)
        if (other > f && intersect(nodes_mm, faces[at], faces[static_cast<std::size_t>(other)]))
          partners[at].push_back(other);
      std::sort(partners[at].begin(), partners[at].end());
    }
  });
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const auto other : partners[f]) pairs.emplace_back(static_cast<std::int32_t>(f), other);
  return pairs;
}

}  // namespace heartgen::validation
