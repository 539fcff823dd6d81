// SPDX-License-Identifier: GPL-3.0-or-later
// Whole meshes of analytic materials: bounds of angles, topology, volumes, surfaces, the same bits.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>

#include "generator/parallel/threads.hpp"
#include "generator/surface_fit/volume_correction.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/surface_faces.hpp"
#include "support/places.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

Fields ball(double radius, const Vec3& center = {}) {
  return {[](const Vec3&) { return 0.0; }, [=](const Vec3& p) { return radius - norm(p - center); }};
}

// A ball of four materials that meet along curves and in a point, with curved interfaces.
Fields four_in_a_ball() {
  return {[](const Vec3& p) { return 4 * norm(p) - 32; }, [](const Vec3& p) { return p.x + 1.8 * std::sin(p.y / 4); },
          [](const Vec3& p) { return -0.5 * p.x + 0.8 * p.y; },
          [](const Vec3& p) { return -0.5 * p.x - 0.8 * p.y + 0.3 * p.z; },
          [](const Vec3& p) { return 0.4 * norm(p) - 3; }};
}

void expect_angles(const Complex& c, double least, double most) {
  const auto range = dihedral_range(c);
  EXPECT_GE(range[0], least);
  EXPECT_LE(range[1], most);
  EXPECT_GT(min_volume(c), 0);
}

// Distance of each constrained node to its surfaces, in lattice widths.
double farthest_node(const Complex& c, const Materials& m) {
  double farthest = 0;
  for (std::size_t n = 0; n < c.nodes_mm.size(); ++n)
    if (tetmesh::is_constrained(c.touches[n]))
      farthest = std::max(farthest, tetmesh::distance_to(tetmesh::feature_at(m, c.touches[n], c.nodes_mm[n])) /
                                        static_cast<double>(c.spacing_mm[n]));
  return farthest;
}

TEST(LatticeMesh, BallHasGoodAnglesItsVolumeAndOneClosedSurface) {
  const auto m = materials_of(ball(12), 14, 1);
  const auto [c, below] = mesh_of(m);
  EXPECT_EQ(below, 0);
  expect_angles(c, 30, 143);
  EXPECT_EQ(defects(c), 0);
  const double exact = 4.0 / 3 * std::numbers::pi * 12 * 12 * 12;
  EXPECT_NEAR(volume_of(c, 1), exact, 0.003 * exact) << "chords of length 1 take 3/12 of 1/12^2 away";
  EXPECT_LT(farthest_node(c, m), 0.05);
}

TEST(LatticeMesh, BalancingSetsTheVolumeRightAndKeepsTheAngles) {
  const auto m = materials_of(ball(8), 10, 1.5);
  auto c = mesh_of(m).complex;
  const double exact = 4.0 / 3 * std::numbers::pi * 8 * 8 * 8;
  const double before = std::abs(volume_of(c, 1) - exact);
  surface_fit::correct_surface_volumes(c, m, 0.49);
  EXPECT_LT(std::abs(volume_of(c, 1) - exact), 0.4 * before);
  EXPECT_NEAR(volume_of(c, 1), exact, 0.004 * exact);
  expect_angles(c, 29, 145);
}

// Distance of the outer faces' centres to the sphere of radius `radius`, in mean edges of the face: p99 and greatest.
std::array<double, 2> distances_to_sphere(const Complex& c, double radius) {
  std::vector<double> found;
  for (const auto& [face, count] : face_counts(c.cells)) {
    if (count != 1) continue;
    const Vec3 a = c.at(face[0]), b = c.at(face[1]), d = c.at(face[2]);
    const double edge = (norm(a - b) + norm(b - d) + norm(d - a)) / 3;
    found.push_back(std::abs(norm((a + b + d) / 3) - radius) / edge);
  }
  std::sort(found.begin(), found.end());
  return {found[found.size() * 99 / 100], found.back()};
}

TEST(LatticeMesh, BalancedFacesLieCloseToTheSurfaceAndKeepItsVolume) {
  for (const double radius : {4.0, 7.0, 12.0}) {  // 3 to 10 edges
    const auto m = materials_of(ball(radius), radius + 2, 1.2);
    auto c = mesh_of(m).complex;
    surface_fit::correct_surface_volumes(c, m, 0.49);
    const auto distances = distances_to_sphere(c, radius);
    EXPECT_LE(distances[0], 0.1) << radius;
    EXPECT_LE(distances[1], 0.3) << radius;
    const double exact = 4.0 / 3 * std::numbers::pi * radius * radius * radius;
    EXPECT_NEAR(volume_of(c, 1), exact, 0.002 * exact) << radius;
  }
}

Complex balanced(const Materials& m) {
  auto c = mesh_of(m).complex;
  surface_fit::correct_surface_volumes(c, m, 0.49);
  return c;
}

// Flat faces take much of what is as narrow as an edge is long: nodes go out far enough to give it back.
TEST(LatticeMesh, BalancingReachesWhatIsNarrow) {
  const double exact = 4.0 / 3 * std::numbers::pi * 2 * 2 * 2;
  EXPECT_NEAR(volume_of(balanced(materials_of(ball(2), 6, 1.2)), 1), exact, 0.02 * exact);
  const auto rod = [](const Vec3& p) { return 1.2 - std::hypot(p.x - 0.1 + 0.3 * p.z, p.y - 0.2 - 0.2 * p.z); };
  const auto m = materials_of({[](const Vec3&) { return 0.0; }, rod}, 6, 1.2);
  const auto c = balanced(m);
  std::vector<double> distances;  // in edges
  for (const auto& face : tetmesh::surface_faces(c)) {
    const Vec3 a = c.at(face.nodes[0]), b = c.at(face.nodes[1]), d = c.at(face.nodes[2]);
    const double edge = (norm(b - a) + norm(d - b) + norm(a - d)) / 3;
    distances.push_back(tetmesh::distance_to(tetmesh::feature_at(m, face.labels, (a + b + d) / 3)) / edge);
  }
  std::sort(distances.begin(), distances.end());
  EXPECT_LE(distances[distances.size() * 99 / 100], 0.1);
  EXPECT_LE(distances.back(), 0.3);
}

// Nodes of the small ball cannot go out far enough; the large ball's make up for it.
TEST(LatticeMesh, EveningOutGivesARegionTheVolumeThatItsNarrowPartsLack) {
  const Vec3 small{-7.4, 0.3, -0.2}, large{2, 0, 0.1};
  constexpr double small_radius = 1.1, large_radius = 5;
  const auto both = [&](const Vec3& p) {
    return std::max(small_radius - norm(p - small), large_radius - norm(p - large));
  };
  const auto m = materials_of({[](const Vec3&) { return 0.0; }, both}, 10, 1.2);
  auto c = balanced(m);
  const double exact = 4.0 / 3 * std::numbers::pi * (std::pow(small_radius, 3) + std::pow(large_radius, 3));
  const double before = std::abs(volume_of(c, 1) / exact - 1);
  EXPECT_GT(before, 0.0005) << "nothing to even out";
  surface_fit::equalize_volumes(c, m, 0.49);
  EXPECT_LT(std::abs(volume_of(c, 1) / exact - 1), 0.5 * before);
  EXPECT_LT(std::abs(volume_of(c, 1) / exact - 1), 0.0007);
  EXPECT_LT(farthest_node(c, m), 0.0801) << "nodes keep their limit";
  expect_angles(c, 29, 145);
}

TEST(LatticeMesh, MaterialsThatMeetSharplyAreBluntedNotBroken) {
  // A wall that thins out to nothing between two pools, at 12 degrees: no good cell fits into its edge.
  const Fields fields{[](const Vec3& p) { return norm(p) - 11; }, [](const Vec3& p) { return p.x - 0.1 * p.z; },
                      [](const Vec3& p) { return -p.x - 0.1 * p.z; }, [](const Vec3&) { return 0.0; }};
  const auto m = materials_of(fields, 13, 1.1);
  auto stuffed = stuffing::stuff_isosurfaces(m, {});
  tetmesh::derive_touches(stuffed);
  tetmesh::compress(stuffed);
  const auto c = mesh_of(m).complex;
  expect_angles(c, 25, 146);
  EXPECT_LE(defects(c), defects(stuffed)) << "labels are not settled here: stuffing may leave pinches";
  for (const int label : {1, 2, 3}) EXPECT_GT(volume_of(c, label), 100) << label;
}

TEST(LatticeMesh, TouchesAreTheLabelsOfTheCells) {
  const auto [c, below] = mesh_of(materials_of(four_in_a_ball(), 14, 1.2));
  std::vector<LabelBits> expected(c.nodes_mm.size(), 0);
  for (std::size_t i = 0; i < c.cells.size(); ++i)
    for (const auto n : c.cells[i]) expected[static_cast<std::size_t>(n)] |= tetmesh::bit_of(c.label[i]);
  for (const auto& [face, count] : face_counts(c.cells))
    for (const auto n : face)
      if (count == 1) expected[static_cast<std::size_t>(n)] |= tetmesh::bit_of(0);
  // A node may have left a label behind in an exchange, but never touches one that it does not know.
  std::size_t more = 0;
  for (std::size_t n = 0; n < expected.size(); ++n) {
    EXPECT_EQ(expected[n] & ~c.touches[n], 0U) << n;
    more += expected[n] != c.touches[n];
  }
  EXPECT_LT(more, expected.size() / 500);
}

TEST(LatticeMesh, SeveralMaterialsMeetConforming) {
  const auto m = materials_of(four_in_a_ball(), 14, 1);
  const auto [c, below] = mesh_of(m);
  expect_angles(c, 25, 145);
  EXPECT_EQ(defects(c), 0);
  int curve_nodes = 0;
  for (const auto bits : c.touches) curve_nodes += std::popcount(bits) >= 3;
  EXPECT_GT(curve_nodes, 50);
  EXPECT_LT(farthest_node(c, m), 0.3);
  // Volumes against counting on a fine grid.
  constexpr double step = 0.2;
  std::array<double, 5> counted{};
  for (const double z : heartgen::testing::steps(-14 + step / 2, 14, step))
    for (const double y : heartgen::testing::steps(-14 + step / 2, 14, step))
      for (const double x : heartgen::testing::steps(-14 + step / 2, 14, step))
        counted[static_cast<std::size_t>(m.label_at({x, y, z}))] += step * step * step;
  for (int label = 1; label < 5; ++label)
    EXPECT_NEAR(volume_of(c, label), counted[static_cast<std::size_t>(label)],
                0.01 * counted[static_cast<std::size_t>(label)] + 2)
        << label;
}

TEST(LatticeMesh, GradedLatticeKeepsTheBounds) {
  auto m = materials_of(four_in_a_ball(), 14, 1);
  m.edge_mm = [](const Vec3& p) { return 0.8 + 0.25 * std::max(0.0, p.z + 6); };
  const auto [c, below] = mesh_of(m);
  expect_angles(c, 25, 145);
  EXPECT_EQ(defects(c), 0);
  const auto [finest, coarsest] = std::minmax_element(c.spacing_mm.begin(), c.spacing_mm.end());
  EXPECT_GT(*coarsest, 1.5F * *finest);
}

TEST(LatticeMesh, SidesOfTheBoxCutFlat) {
  // A ball that sticks out of the box through all six sides.
  const auto m = materials_of(ball(13), 10, 1.1);
  const auto [c, below] = mesh_of(m);
  expect_angles(c, 30, 143);
  EXPECT_EQ(defects(c), 0);
  double on_sides = 0;
  for (const auto& [face, count] : face_counts(c.cells)) {
    if (count != 1) continue;
    const LabelBits sides = c.bits(face[0]) & c.bits(face[1]) & c.bits(face[2]) & tetmesh::side_bits;
    if (sides != 0) on_sides += 0.5 * norm(cross(c.at(face[1]) - c.at(face[0]), c.at(face[2]) - c.at(face[0])));
  }
  const double exact = 6 * std::numbers::pi * (13.0 * 13 - 10 * 10);
  EXPECT_NEAR(on_sides, exact, 0.02 * exact);
  for (std::size_t n = 0; n < c.nodes_mm.size(); ++n)
    for (int side = 0; side < 6; ++side)
      if ((c.touches[n] & tetmesh::bit_of(tetmesh::first_side + side)) != 0) {
        EXPECT_EQ(c.nodes_mm[n][side / 2], side % 2 == 0 ? -10 : 10);
      }
}

TEST(LatticeMesh, ThinShellKeepsItsTopology) {
  // A wall of 1.6 edges between two materials and the outside.
  const Fields fields{[](const Vec3& p) { return norm(p) - 10.6; }, [](const Vec3& p) { return 9 - norm(p); },
                      [](const Vec3& p) { return 0.5 * (0.8 - std::abs(norm(p) - 9.8)); }};
  const auto [c, below] = mesh_of(materials_of(fields, 12, 1));
  expect_angles(c, 25, 145);
  EXPECT_EQ(defects(c), 0);
  std::vector<Cell> wall;
  for (std::size_t i = 0; i < c.cells.size(); ++i)
    if (c.label[i] == 2) wall.push_back(c.cells[i]);
  std::int64_t nodes = 0, edges = 0, faces = 0;
  std::map<std::int32_t, int> node_seen;
  std::map<std::pair<std::int32_t, std::int32_t>, int> edge_seen;
  for (const auto& [face, count] : face_counts(wall)) {
    if (count != 1) continue;
    ++faces;
    for (std::size_t i = 0; i < 3; ++i) {
      nodes += node_seen[face[i]]++ == 0;
      edges += edge_seen[std::minmax(face[i], face[(i + 1) % 3])]++ == 0;
    }
  }
  EXPECT_EQ(nodes - edges + faces, 4) << "two spheres: no hole in the wall";
}

TEST(LatticeMesh, SheetThinnerThanAnEdgeHasNoDents) {
  // The outside is on both of its sides: no label tells an edge that goes through it from one that does not.
  const double thickness = 0.8;
  const Fields shell{[](const Vec3&) { return 0.0; },
                     [=](const Vec3& p) { return 0.5 * thickness - std::abs(norm(p) - 8); }};
  const auto m = materials_of(shell, 10, 1.2);
  const auto c = mesh_of(m).complex;
  const double inner = 8 - 0.5 * thickness, outer = 8 + 0.5 * thickness;
  const double exact = 4.0 / 3 * std::numbers::pi * (outer * outer * outer - inner * inner * inner);
  EXPECT_NEAR(volume_of(c, 1), exact, 0.03 * exact);
  int dents = 0;
  for (const auto& [face, count] : face_counts(c.cells)) {
    const double radius = norm((c.at(face[0]) + c.at(face[1]) + c.at(face[2])) / 3);
    dents += count == 1 && std::abs(radius - 8) < 0.25 * thickness;
  }
  EXPECT_EQ(dents, 0);
}

TEST(LatticeMesh, RepairNeverLowersTheWorstCell) {
  const auto m = materials_of(four_in_a_ball(), 14, 1.2);
  auto c = stuffing::stuff_isosurfaces(m, {});
  tetmesh::derive_touches(c);
  tetmesh::compress(c);
  double before = 1;
  for (const auto q : c.quality) before = std::min(before, static_cast<double>(q));
  for (int sweeps = 1; sweeps <= 3; ++sweeps) {
    tetmesh::RepairSettings settings;
    settings.sweeps = sweeps;
    auto repaired = c;
    tetmesh::repair(repaired, m, settings);
    double after = 1;
    for (std::size_t i = 0; i < repaired.cells.size(); ++i)
      if (repaired.cells[i][0] >= 0) after = std::min(after, tetmesh::quality(repaired, repaired.cells[i]));
    EXPECT_GE(after, before - 1e-6) << sweeps;
    EXPECT_EQ(defects(repaired), 0);
  }
}

TEST(LatticeMesh, SameBitsForAnyNumberOfThreads) {
  const auto m = materials_of(four_in_a_ball(), 14, 1.5);
  const int threads = parallel::thread_count();
  parallel::set_thread_count(1);
  const auto one = mesh_of(m).complex;
  for (const int count : {2, 3}) {
    parallel::set_thread_count(count);
    const auto more = mesh_of(m).complex;
    EXPECT_EQ(one.nodes_mm, more.nodes_mm);
    EXPECT_EQ(one.cells, more.cells);
    EXPECT_EQ(one.label, more.label);
  }
  parallel::set_thread_count(threads);
}

TEST(LatticeMesh, NothingInsideGivesNothing) {
  const auto [c, below] = mesh_of(materials_of(ball(-1), 6, 1));
  EXPECT_TRUE(c.cells.empty());
  EXPECT_TRUE(c.nodes_mm.empty());
}

// Walls of random thickness around two pools, in random poses, with bumps: what nobody looked at.
class RandomWalls : public ::testing::TestWithParam<int> {};

TEST_P(RandomWalls, MeetTheBounds) {
  std::mt19937 random(static_cast<std::uint32_t>(GetParam()));
  const auto number = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() % 10000) / 10000;
  };
  const double wall = number(1.5, 5), bump = number(0, 0.5), wave = number(0.3, 0.8);
  const Vec3 shift{number(-1, 1), number(-1, 1), number(-1, 1)}, turn{number(-1, 1), number(-1, 1), number(-1, 1)};
  const auto left = [=](const Vec3& p) {
    const Vec3 q = p - shift + cross(turn, p) * 0.3;
    return 7 - std::sqrt(q.x * q.x + 0.6 * q.y * q.y + 0.8 * q.z * q.z) +
           bump * std::sin(wave * p.x) * std::sin(wave * p.y + 1) * std::sin(wave * p.z);
  };
  const auto right = [=](const Vec3& p) { return 5 - norm(p - shift - Vec3{9 + 0.5 * wall, 2, 0}); };
  const Fields fields{[=](const Vec3& p) { return -2 * (std::max(left(p), right(p)) + wall); },
                      [=](const Vec3& p) { return 2 * left(p); }, [=](const Vec3& p) { return 2 * right(p); },
                      [](const Vec3&) { return 0.0; }};
  const auto [c, below] = mesh_of(materials_of(fields, 20, 1.2));
  expect_angles(c, 25, 145);
  EXPECT_EQ(defects(c), 0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomWalls, ::testing::Range(1, 7));

}  // namespace
