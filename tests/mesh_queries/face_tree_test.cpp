// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mesh_queries/face_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace heartgen;

struct Numbers {
  std::uint32_t state = 3;
  double next() {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8) / 16777216.0;
  }
  Vec3 point() {
    const double x = next(), y = next(), z = next();
    return {x, y, z};
  }
};

std::vector<mesh_queries::Triangle> soup(int count, double size) {
  Numbers numbers;
  std::vector<mesh_queries::Triangle> triangles;
  for (int i = 0; i < count; ++i) {
    const Vec3 at = numbers.point();
    triangles.push_back({at, at + size * numbers.point(), at + size * numbers.point()});
  }
  return triangles;
}

/// By looking at many points of the triangle.
double sampled_distance(const mesh_queries::Triangle& t, const Vec3& p) {
  double least = 1e9;
  constexpr int steps = 60;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j) {
      const double u = i / double(steps), v = j / double(steps);
      least = std::min(least, norm((1 - u - v) * t[0] + u * t[1] + v * t[2] - p));
    }
  return least;
}

TEST(NearestOnTriangle, IsNeverBeatenByASample) {
  Numbers numbers{17};
  for (const auto& t : soup(40, 1)) {
    const Vec3 p = 2 * numbers.point() - Vec3{0.5, 0.5, 0.5};
    const double distance = norm(mesh_queries::nearest_on_triangle(t, p) - p), sampled = sampled_distance(t, p);
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GT(distance, sampled - 0.05);
  }
}

TEST(NearestOnTriangle, WithoutAreaItIsASegmentOrAPoint) {
  EXPECT_EQ(mesh_queries::nearest_on_triangle({Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{1, 0, 0}}, {1.5, 1, 0}),
            (Vec3{1.5, 0, 0}));
  EXPECT_EQ(mesh_queries::nearest_on_triangle({Vec3{1, 1, 1}, Vec3{1, 1, 1}, Vec3{1, 1, 1}}, {5, 1, 0}),
            (Vec3{1, 1, 1}));
}

TEST(FaceTree, NearestIsThatOfLookingAtAll) {
  const auto triangles = soup(500, 0.1);
  const auto tree = mesh_queries::make_face_tree(triangles);
  Numbers numbers{5};
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = numbers.point();
    const auto odd = [](std::int32_t face) { return face % 2 == 1; };
    for (const bool any : {true, false}) {
      std::int32_t best = -1;
      double least = 1e9;
      for (std::int32_t f = 0; f < 500; ++f) {
        const double d = norm(mesh_queries::nearest_on_triangle(triangles[static_cast<std::size_t>(f)], p) - p);
        if ((any || odd(f)) && d < least) least = d, best = f;
      }
      const auto found = any ? mesh_queries::nearest_face(tree, p, 10) : mesh_queries::nearest_face(tree, p, 10, odd);
      EXPECT_EQ(found.face, best);
      EXPECT_NEAR(found.distance_mm, least, 1e-12);
      EXPECT_EQ(mesh_queries::nearest_face(tree, p, 0.5 * least, any ? std::function<bool(std::int32_t)>{} : odd).face,
                -1);
    }
  }
}

TEST(FaceTree, BoxFindsExactlyTheBoxesThatMeetIt) {
  const auto triangles = soup(300, 0.2);
  const auto tree = mesh_queries::make_face_tree(triangles);
  Numbers numbers{8};
  for (int i = 0; i < 50; ++i) {
    const Vec3 low = numbers.point(), high = low + 0.3 * numbers.point();
    std::vector<std::int32_t> expected, found;
    for (std::int32_t f = 0; f < 300; ++f) {
      const auto& t = triangles[static_cast<std::size_t>(f)];
      bool meets = true;
      for (int axis = 0; axis < 3; ++axis)
        meets = meets && std::min({t[0][axis], t[1][axis], t[2][axis]}) <= high[axis] &&
                std::max({t[0][axis], t[1][axis], t[2][axis]}) >= low[axis];
      if (meets) expected.push_back(f);
    }
    mesh_queries::faces_in_box(tree, low, high, found);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  }
}

TEST(FaceTree, EmptyAndRepeatedTriangles) {
  EXPECT_EQ(
      mesh_queries::nearest_face(mesh_queries::make_face_tree(std::vector<mesh_queries::Triangle>{}), {0, 0, 0}, 1e9)
          .face,
      -1);
  const std::vector<mesh_queries::Triangle> same(20,
                                                 mesh_queries::Triangle{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}});
  EXPECT_EQ(mesh_queries::nearest_face(mesh_queries::make_face_tree(same), {0.2, 0.2, 3}, 1e9).face, 0)
      << "the smallest id of equals";
}

}  // namespace
