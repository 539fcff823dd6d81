// SPDX-License-Identifier: GPL-3.0-or-later
// DistMesh in space, with the repair of its slivers.
#include <gtest/gtest.h>

#include "generator/distmesh/tetrahedra.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

struct Tetrahedra {
  Complex complex;
  std::int64_t below_goal = 0;
};

Tetrahedra tetrahedra_of(const Materials& m, double edge_mm) {
  const auto dimension = distmesh::Dimension::three;
  const auto truss = distmesh::relax(m, dimension, edge_mm, distmesh::default_settings(dimension));
  EXPECT_EQ(truss.crossing, 0);
  Tetrahedra made{distmesh::complex_of(truss, m), 0};
  tetmesh::derive_touches(made.complex);
  tetmesh::compress(made.complex);
  made.below_goal = tetmesh::repair(made.complex, m, {});
  tetmesh::compress(made.complex);
  return made;
}

Fields ball(double radius) {
  return {[](const Vec3&) { return 0.0; }, [=](const Vec3& p) { return radius - norm(p); }};
}

void expect_good(const Tetrahedra& made) {
  EXPECT_EQ(made.below_goal, 0);
  EXPECT_GT(min_volume(made.complex), 0);
  const auto [least, greatest] = dihedral_range(made.complex);
  EXPECT_GE(least, 25);
  EXPECT_LE(greatest, 145);
}

TEST(DistMeshSpace, BallHasItsVolumeAndAClosedSurface) {
  const auto made = tetrahedra_of(materials_of(ball(9), 12, 1.5), 1.5);
  expect_good(made);
  EXPECT_EQ(defects(made.complex), 0);
  const double exact = 4.0 / 3 * std::numbers::pi * 9 * 9 * 9;
  EXPECT_NEAR(volume_of(made.complex, 1), exact, exact * (1.5 * 1.5) / (9 * 9));
}

// Where the hull of all nodes is the surface there is no simplex beyond it.
TEST(DistMeshSpace, TheWholeSurfaceOfABallTouchesTheOutside) {
  const auto m = materials_of(ball(9), 12, 1.5);
  const auto dimension = distmesh::Dimension::three;
  auto complex = distmesh::complex_of(distmesh::relax(m, dimension, 1.5, distmesh::default_settings(dimension)), m);
  tetmesh::derive_touches(complex);
  tetmesh::compress(complex);
  int outer_faces = 0;
  for (const auto& cell : complex.cells)
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      const auto a = cell[(left_out + 1) % 4], b = cell[(left_out + 2) % 4], c = cell[(left_out + 3) % 4];
      if (tetmesh::cells_at_face(complex, a, b, c)[1] >= 0) continue;
      ++outer_faces;
      EXPECT_NE(complex.bits(a) & complex.bits(b) & complex.bits(c) & tetmesh::bit_of(0), 0U);
    }
  EXPECT_GT(outer_faces, 100);
}

TEST(DistMeshSpace, HalvesOfABallShareTheirPlaneAndTheBoxIsFlat) {
  const Fields fields{[](const Vec3&) { return 0.0; }, [](const Vec3& p) { return std::min(20 - norm(p), 1 + p.z); },
                      [](const Vec3& p) { return std::min(20 - norm(p), 1 - p.z); }};
  const auto made = tetrahedra_of(materials_of(fields, 5, 1.3), 1.3);
  expect_good(made);
  EXPECT_NEAR(volume_of(made.complex, 1), 500, 500 * 0.03);
  EXPECT_NEAR(volume_of(made.complex, 1) + volume_of(made.complex, 2), 1000, 1e-6);
}

TEST(DistMeshSpace, FourMaterialsMeetInOneMesh) {
  const Fields fields{[](const Vec3& p) { return 4 * norm(p) - 32; },
                      [](const Vec3& p) { return p.x + 1.8 * std::sin(p.y / 4); },
                      [](const Vec3& p) { return -0.5 * p.x + 0.8 * p.y; },
                      [](const Vec3& p) { return -0.5 * p.x - 0.8 * p.y + 0.3 * p.z; },
                      [](const Vec3& p) { return 0.4 * norm(p) - 3; }};
  const auto made = tetrahedra_of(materials_of(fields, 14, 1.6), 1.6);
  EXPECT_EQ(defects(made.complex), 0);
  expect_good(made);
  for (const int label : {1, 2, 3}) EXPECT_GT(volume_of(made.complex, label), 100) << label;
}

TEST(DistMeshSpace, TheSameInputGivesTheSameBits) {
  const auto m = materials_of(ball(6), 8, 1.6);
  const auto one = tetrahedra_of(m, 1.6), other = tetrahedra_of(m, 1.6);
  EXPECT_EQ(one.complex.nodes_mm, other.complex.nodes_mm);
  EXPECT_EQ(one.complex.cells, other.complex.cells);
}

}  // namespace
