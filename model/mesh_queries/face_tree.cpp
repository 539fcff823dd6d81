// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mesh_queries/face_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace heartgen::mesh_queries {
namespace {

constexpr std::int32_t leaf_size = 4;

void include(FaceTree::Node& node, const Vec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    node.low_mm[axis] = std::min(node.low_mm[axis], p[axis]);
    node.high_mm[axis] = std::max(node.high_mm[axis], p[axis]);
  }
}

/// Halves the triangles by their middles along the longest side of the middles' box.
void build(FaceTree& tree, const std::vector<Vec3>& middles, std::int32_t begin, std::int32_t end) {
  const auto id = tree.nodes.size();
  FaceTree::Node node, box;
  node.begin = begin;
  node.end = end;
  const auto at = [&](std::int32_t i) { return static_cast<std::size_t>(tree.order[static_cast<std::size_t>(i)]); };
  node.low_mm = node.high_mm = tree.triangles_mm[at(begin)][0];
  box.low_mm = box.high_mm = middles[at(begin)];
  for (auto i = begin; i < end; ++i) {
    for (const Vec3& p : tree.triangles_mm[at(i)]) include(node, p);
    include(box, middles[at(i)]);
  }
  tree.nodes.push_back(node);
  if (end - begin <= leaf_size) return;
  const Vec3 size = box.high_mm - box.low_mm;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto middle = begin + (end - begin) / 2;
  std::nth_element(tree.order.begin() + begin, tree.order.begin() + middle, tree.order.begin() + end,
                   [&](std::int32_t a, std::int32_t b) {
                     const double x = middles[static_cast<std::size_t>(a)][axis];
                     const double y = middles[static_cast<std::size_t>(b)][axis];
                     return x != y ? x < y : a < b;
                   });
  build(tree, middles, begin, middle);
  tree.nodes[id].second = static_cast<std::int32_t>(tree.nodes.size());
  build(tree, middles, middle, end);
}

double squared_distance(const FaceTree::Node& node, const Vec3& p) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = std::max({node.low_mm[axis] - p[axis], p[axis] - node.high_mm[axis], 0.0});
    sum += d * d;
  }
  return sum;
}

struct Search {
  const FaceTree* tree;
  Vec3 point;
  const std::function<bool(std::int32_t)>* accept;
  double best;  // squared
  NearestFace found{};

  void visit(std::size_t id) {
    const auto& node = tree->nodes[id];
    if (squared_distance(node, point) > best) return;
    if (node.second >= 0) {
      auto first = id + 1, second = static_cast<std::size_t>(node.second);
      if (squared_distance(tree->nodes[second], point) < squared_distance(tree->nodes[first], point))
        std::swap(first, second);
      visit(first);
      visit(second);
      return;
    }
    for (auto i = node.begin; i < node.end; ++i) take(tree->order[static_cast<std::size_t>(i)]);
  }
  void take(std::int32_t face) {
    if (*accept && !(*accept)(face)) return;
    const Vec3 on = nearest_on_triangle(tree->triangles_mm[static_cast<std::size_t>(face)], point);
    const double squared = dot(on - point, on - point);
    const bool nearer = squared < best || (squared == best && (found.face < 0 || face < found.face));
    if (!nearer) return;
    best = squared;
    found = {face, on, std::sqrt(squared)};
  }
};

void collect(const FaceTree& tree, std::size_t id, const Vec3& low, const Vec3& high,
             std::vector<std::int32_t>& faces) {
  const auto& node = tree.nodes[id];
  for (int axis = 0; axis < 3; ++axis)
    if (node.low_mm[axis] > high[axis] || node.high_mm[axis] < low[axis]) return;
  if (node.second >= 0) {
    collect(tree, id + 1, low, high, faces);
    collect(tree, static_cast<std::size_t>(node.second), low, high, faces);
    return;
  }
  for (auto i = node.begin; i < node.end; ++i) {
    const auto face = tree.order[static_cast<std::size_t>(i)];
    const auto& t = tree.triangles_mm[static_cast<std::size_t>(face)];
    bool apart = false;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [least, most] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
      apart |= least > high[axis] || most < low[axis];
    }
    if (!apart) faces.push_back(face);
  }
}

/// The point of the segment ab nearest to p.
Vec3 nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 way = b - a;
  const double length = dot(way, way);
  return length > 0 ? a + std::clamp(dot(p - a, way) / length, 0.0, 1.0) * way : a;
}

}  // namespace

FaceTree make_face_tree(std::vector<Triangle> triangles_mm) {
  FaceTree tree;
  tree.triangles_mm = std::move(triangles_mm);
  tree.order.resize(tree.triangles_mm.size());
  std::iota(tree.order.begin(), tree.order.end(), 0);
  std::vector<Vec3> middles;
  middles.reserve(tree.order.size());
  for (const auto& t : tree.triangles_mm) middles.push_back((t[0] + t[1] + t[2]) / 3);
  if (!tree.order.empty()) build(tree, middles, 0, static_cast<std::int32_t>(tree.order.size()));
  return tree;
}

FaceTree make_face_tree(const std::vector<Vec3>& nodes_mm, const std::vector<Face>& faces) {
  std::vector<Triangle> triangles;
  triangles.reserve(faces.size());
  for (const auto& face : faces)
    triangles.push_back({nodes_mm[static_cast<std::size_t>(face[0])], nodes_mm[static_cast<std::size_t>(face[1])],
                         nodes_mm[static_cast<std::size_t>(face[2])]});
  return make_face_tree(std::move(triangles));
}

NearestFace nearest_face(const FaceTree& tree, const Vec3& point_mm, double reach_mm,
                         const std::function<bool(std::int32_t)>& accept) {
  if (tree.nodes.empty()) return {};
  Search search{&tree, point_mm, &accept, reach_mm * reach_mm};
  search.visit(0);
  return search.found;
}

void faces_in_box(const FaceTree& tree, const Vec3& low_mm, const Vec3& high_mm, std::vector<std::int32_t>& faces) {
  if (!tree.nodes.empty()) collect(tree, 0, low_mm, high_mm, faces);
}

Vec3 nearest_on_triangle(const Triangle& t, const Vec3& point) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double squared = dot(normal, normal);
  if (squared > 0) {
    const Vec3 on = point - (dot(point - t[0], normal) / squared) * normal;
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) inside = inside && dot(cross(t[(i + 1) % 3] - t[i], on - t[i]), normal) >= 0;
    if (inside) return on;
  }
  Vec3 best = nearest_on_segment(t[0], t[1], point);
  for (std::size_t i = 1; i < 3; ++i) {
    const Vec3 on = nearest_on_segment(t[i], t[(i + 1) % 3], point);
    if (dot(on - point, on - point) < dot(best - point, best - point)) best = on;
  }
  return best;
}

}  // namespace heartgen::mesh_queries
