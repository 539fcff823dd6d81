// SPDX-License-Identifier: GPL-3.0-or-later
// Faces across creases of a surface get nearer to it.
#include "generator/surface_fit/tangential_relaxation.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "generator/parallel/threads.hpp"
#include "generator/surface_fit/volume_correction.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/surface_faces.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

constexpr double least = 0.49;

// Two balls that meet in a groove; a cube, smooth nowhere but on its sides; in poses that the lattice knows nothing of.
std::vector<Materials> creased() {
  const auto nowhere = [](const Vec3&) { return -100.0; };
  const auto around = [](const Vec3&) { return 0.0; };
  const auto balls = [](const Vec3& p) {
    const Vec3 q = p - Vec3{0.1, 0.2, 0.3};
    return std::max(4.5 - norm(q - Vec3{3.4, 0, 0}), 4.5 - norm(q + Vec3{3.4, 0, 0}));
  };
  const auto cube = [](const Vec3& p) {
    const Vec3 u = normalized({1, 0.3, 0.2}), v = normalized(cross(u, {0.1, -0.2, 1})), w = cross(u, v);
    return 5 - std::max({std::abs(dot(p, u)), std::abs(dot(p, v)), std::abs(dot(p, w))});
  };
  return {materials_of({nowhere, around, balls}, 9, 0.9), materials_of({nowhere, around, cube}, 10, 1.1)};
}

Complex balanced(const Materials& m) {
  auto c = mesh_of(m).complex;
  surface_fit::correct_surface_volumes(c, m, least);
  return c;
}

/// Of the faces' centres, in edges.
struct Errors {
  double squares = 0;    // sum
  std::size_t many = 0;  // beyond a tenth
};

Errors errors_of(const Complex& c, const Materials& materials) {
  Errors errors;
  for (const auto& face : tetmesh::surface_faces(c)) {
    const Vec3 a = c.at(face.nodes[0]), b = c.at(face.nodes[1]), d = c.at(face.nodes[2]);
    const double distance = tetmesh::distance_to(tetmesh::feature_at(materials, face.labels, (a + b + d) / 3));
    const double error = 3 * distance / (norm(b - a) + norm(d - b) + norm(a - d));
    errors.squares += error * error;
    errors.many += error > 0.1;
  }
  return errors;
}

double worst_quality(const Complex& c) {
  return static_cast<double>(*std::min_element(c.quality.begin(), c.quality.end()));
}

bool same_nodes(const Complex& a, const Complex& b) {
  return a.nodes_mm.size() == b.nodes_mm.size() &&
         std::memcmp(a.nodes_mm.data(), b.nodes_mm.data(), a.nodes_mm.size() * sizeof(Vec3)) == 0;
}

TEST(Ease, FacesAcrossCreasesGetNearer) {
  for (const auto& m : creased()) {
    auto c = balanced(m);
    const auto before = errors_of(c, m);
    const double quality = worst_quality(c);
    ASSERT_GT(before.many, 10U);
    surface_fit::relax_tangentially(c, m, least, ~0U);
    const auto after = errors_of(c, m);
    EXPECT_LT(after.many, before.many / 2);
    EXPECT_LT(after.squares, 0.7 * before.squares);
    EXPECT_GE(worst_quality(c), std::min(quality, least) - 1e-6);
    for (std::size_t t = 0; t < c.cells.size(); ++t)
      EXPECT_NEAR(static_cast<double>(c.quality[t]), tetmesh::quality(c, c.cells[t]), 1e-6);
  }
}

TEST(Ease, FrozenNodesAndOtherSurfacesStay) {
  const auto m = creased()[0];
  const auto before = balanced(m);
  auto c = before;
  surface_fit::relax_tangentially(c, m, least, tetmesh::bit_of(5));
  EXPECT_TRUE(same_nodes(c, before));
  c.frozen.assign(c.nodes_mm.size(), 1);
  surface_fit::relax_tangentially(c, m, least, ~0U);
  EXPECT_TRUE(same_nodes(c, before));
}

TEST(Ease, OuterSurfacesStay) {
  const auto m = materials_of({[](const Vec3&) { return 0.0; },
                               [](const Vec3& p) { return 4 - std::abs(p.x) - std::abs(p.y) - std::abs(p.z); }},
                              6, 0.9);
  const auto before = balanced(m);
  auto c = before;
  surface_fit::relax_tangentially(c, m, least, ~0U);
  EXPECT_TRUE(same_nodes(c, before));
}

TEST(Ease, SameBitsForAnyNumberOfThreads) {
  const auto m = creased()[1];
  const auto start = balanced(m);
  const int threads = parallel::thread_count();
  std::vector<Complex> made;
  for (const int count : {1, 2, 5}) {
    parallel::set_thread_count(count);
    made.push_back(start);
    surface_fit::relax_tangentially(made.back(), m, least, ~0U);
  }
  parallel::set_thread_count(threads);
  for (const auto& c : made) EXPECT_TRUE(same_nodes(c, made[0]));
  EXPECT_FALSE(same_nodes(made[0], start));
}

}  // namespace
