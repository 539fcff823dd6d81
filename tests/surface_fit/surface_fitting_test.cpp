// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/surface_fitting.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/repair.hpp"
#include "generator/tetmesh/surface_deviation.hpp"
#include "generator/tetmesh/surface_faces.hpp"
#include "tetmesh/shapes.hpp"

namespace {

using namespace heartgen;
using namespace heartgen::testing;

// Two balls that meet in a groove, at which faces leave the surface.
Materials two_balls() {
  return materials_of({[](const Vec3&) { return 0.0; },
                       [](const Vec3& p) {
                         const Vec3 q = p - Vec3{0.1, 0.2, 0.3};
                         return std::max(4.5 - norm(q - Vec3{3.4, 0, 0}), 4.5 - norm(q + Vec3{3.4, 0, 0}));
                       }},
                      10, 0.9);
}

double worst_error(const Complex& c, const Materials& materials) {
  double worst = 0;
  for (const auto& face : tetmesh::surface_faces(c)) {
    const Vec3 a = c.at(face.nodes[0]), b = c.at(face.nodes[1]), d = c.at(face.nodes[2]);
    const auto feature = tetmesh::feature_at(materials, face.labels, (a + b + d) / 3);
    worst = std::max(worst, 3 * tetmesh::distance_to(feature) / (norm(b - a) + norm(d - b) + norm(a - d)));
  }
  return worst;
}

double worst_quality(const Complex& c) {
  return static_cast<double>(*std::min_element(c.quality.begin(), c.quality.end()));
}

TEST(Fit, FacesInAGrooveGetNearToTheirSurface) {
  const auto m = two_balls();
  auto c = mesh_of(m).complex;
  const double before = worst_error(c, m), quality = worst_quality(c);
  surface_fit::FitSettings settings;
  settings.aim = 0.15;
  ASSERT_GT(before, settings.aim);
  const auto missed = surface_fit::fit_surfaces(c, m, {}, settings);
  EXPECT_EQ(missed, 0);
  EXPECT_LT(worst_error(c, m), settings.aim + 1e-12);
  EXPECT_GE(worst_quality(c), std::min(quality, settings.enough) - 1e-6);
  tetmesh::compress(c);
  EXPECT_EQ(defects(c), 0);
  EXPECT_GT(min_volume(c), 0);
}

// What fits can be kept so while cells get better; repair alone does not look at the middles of faces.
TEST(Fit, RepairSparesFacesThatFit) {
  const auto m = two_balls();
  auto start = mesh_of(m).complex;
  constexpr double limit = 0.15;
  surface_fit::FitSettings settings;
  settings.aim = limit;
  ASSERT_EQ(surface_fit::fit_surfaces(start, m, {}, settings), 0);
  ASSERT_LT(worst_error(start, m), limit + 1e-12);
  tetmesh::RepairSettings repairing;
  repairing.goal = repairing.least = 0.6;
  repairing.sweeps = 5;
  auto spoilt = start, spared = start;
  tetmesh::repair(spoilt, m, repairing);
  repairing.face = limit;
  tetmesh::repair(spared, m, repairing);
  EXPECT_GT(worst_error(spoilt, m), limit);
  EXPECT_LT(worst_error(spared, m), limit + 1e-12);
  EXPECT_GE(worst_quality(spared), worst_quality(start));
  const auto bad_in = [](const Complex& c) {
    return std::ranges::count_if(c.quality, [](float q) { return q < 0.55F; });
  };
  EXPECT_LT(bad_in(spared), bad_in(start) / 2);
}

// A ball with a wedge cut out, open upwards, its edge along y.
struct Notched {
  double sine, cosine;  // of half the wedge's angle
  double edge_x, edge_z;

  double value(const Vec3& p) const {
    return std::min(5 - norm(p), cosine * std::abs(p.x - edge_x) - sine * (p.z - edge_z));
  }
  // Below the wedge's edge its sides are nearer to first order than the edge is.
  double distance(const Vec3& p) const {
    const double aside = std::abs(p.x - edge_x), above = p.z - edge_z;
    const double to_wedge = sine * aside + cosine * above < 0 ? std::hypot(aside, above) : std::abs(value(p));
    return std::min(std::abs(5 - norm(p)), to_wedge);
  }
};

double worst_distance(const Complex& c, const Notched& notched) {
  double worst = 0;
  for (const auto& face : tetmesh::surface_faces(c)) {
    const Vec3 a = c.at(face.nodes[0]), b = c.at(face.nodes[1]), d = c.at(face.nodes[2]);
    worst = std::max(worst, 3 * notched.distance((a + b + d) / 3) / (norm(b - a) + norm(d - b) + norm(a - d)));
  }
  return worst;
}

// Both sides of a surface are looked for around a face's middle: where first-order distances are too small, that tells.
// Where a level set that does not grow evenly comes near to 0 and turns back, its slope makes the surface seem near.
TEST(Fit, NodesFarFromTheirSurfaceAreSeenWhereTheLevelSetMakesThemSeemNear) {
  constexpr double turn_mm = 0.3, steep = 29;
  const auto depth = [](const Vec3& p) { return 6 - norm(p); };
  const auto turned = [&](const Vec3& p) {
    const double t = depth(p);
    if (t > -turn_mm) return t;
    const double beyond = -turn_mm - t;
    return beyond < 0.01 ? -turn_mm + steep * beyond : -turn_mm + 0.01 * steep - (beyond - 0.01);
  };
  const auto even = materials_of({[](const Vec3&) { return 0.0; }, depth}, 8, 0.7);
  const auto uneven = materials_of({[](const Vec3&) { return 0.0; }, turned}, 8, 0.7);
  auto c = mesh_of(even).complex;
  const auto faces = tetmesh::surface_faces(c);
  const auto node = faces.front().nodes[0];
  ASSERT_TRUE(tetmesh::deviating_faces(c, uneven, 0.29, ~0U, faces).empty());
  c.nodes_mm[static_cast<std::size_t>(node)] *= (6 + turn_mm + 0.009) / norm(c.at(node));
  ASSERT_LT(tetmesh::distance_to(tetmesh::feature_at(uneven, c.bits(node), c.at(node))), 0.01);
  const auto found = tetmesh::deviating_faces(c, uneven, 0.29, ~0U, faces);
  const auto at_node = [&](const Face& face) { return std::ranges::find(face, node) != face.end(); };
  EXPECT_GE(found.size(), 3U);
  EXPECT_TRUE(std::ranges::all_of(found, at_node));
}

TEST(Fit, FacesReachTheBottomOfANotch) {
  constexpr double beyond_aim = 0.31, before_aim = 0.28;  // steps of the search, in edges
  double farthest_before = 0;
  for (const double shift : {0.0, 0.2, 0.4, 0.6, 0.8})
    for (const double sine : {0.44, 0.6}) {
      const Notched notched{sine, std::sqrt(1 - sine * sine), 0.13 + shift, 0.2 - 0.5 * shift};
      const auto m =
          materials_of({[](const Vec3&) { return 0.0; }, [&](const Vec3& p) { return notched.value(p); }}, 7, 1);
      auto c = mesh_of(m).complex;
      farthest_before = std::max(farthest_before, worst_distance(c, notched));
      const auto defects_before = defects(c);
      EXPECT_EQ(surface_fit::fit_surfaces(c, m, {}, {}), 0) << shift << ' ' << sine;
      EXPECT_LT(worst_distance(c, notched), before_aim + 1e-9) << shift << ' ' << sine;
      tetmesh::compress(c);
      EXPECT_EQ(defects(c), defects_before);
    }
  EXPECT_GT(farthest_before, beyond_aim);
}

// A ball of two halves. A node of the curve that is off the plane between them lies on the sphere still, and faces
// around it hardly leave theirs.
TEST(Fit, NodesComeBackToTheirCurve) {
  const auto m = ball_of_two_halves({0.1, 0.2, 0.3});
  auto c = mesh_of(m).complex;
  const Vec3 middle{0.1, 0.2, 0.3};
  const auto is_on_curve = [&](std::int32_t n) {
    return std::popcount(c.bits(n) & ~tetmesh::side_bits) > 2 && !c.star(n).empty();
  };
  const auto farthest = [&] {
    double found = 0;
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(c.nodes_mm.size()); ++n)
      if (is_on_curve(n)) found = std::max(found, tetmesh::distance_to(tetmesh::feature_at(m, c.bits(n), c.at(n))));
    return found;
  };
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(c.nodes_mm.size()) && farthest() < 0.3; ++n) {
    if (!is_on_curve(n)) continue;
    const Vec3 from_middle = c.at(n) - middle;
    for (const double way : {0.35, -0.35})
      tetmesh::shift_node(c, n, 5 * normalized(from_middle + Vec3{0, 0, way}) - from_middle, 1, 0.02);
  }
  ASSERT_GT(farthest(), 0.3);
  surface_fit::FitSettings settings;
  surface_fit::fit_surfaces(c, m, {}, settings);
  EXPECT_LT(farthest(), 0.29);
}

TEST(Fit, NothingChangesWithoutWork) {
  const auto m = two_balls();
  auto c = mesh_of(m).complex;
  const auto before = c.nodes_mm;
  surface_fit::FitSettings settings;
  settings.aim = 0.15;
  settings.max_work = 0;
  EXPECT_GT(surface_fit::fit_surfaces(c, m, {}, settings), 0);
  EXPECT_EQ(c.nodes_mm.size(), before.size());
}

TEST(Fit, OtherSurfacesStay) {
  const auto m = two_balls();
  auto c = mesh_of(m).complex;
  const auto before = c.nodes_mm;
  surface_fit::FitSettings settings;
  settings.aim = 0.15;
  settings.labels = tetmesh::bit_of(5);
  EXPECT_EQ(surface_fit::fit_surfaces(c, m, {}, settings), 0);
  ASSERT_EQ(c.nodes_mm.size(), before.size());
  EXPECT_EQ(std::memcmp(c.nodes_mm.data(), before.data(), before.size() * sizeof(Vec3)), 0);
}

TEST(Fit, SameBitsForAnyNumberOfThreads) {
  const auto m = two_balls();
  const auto start = mesh_of(m).complex;
  surface_fit::FitSettings settings;
  settings.aim = 0.15;
  std::vector<Complex> made;
  for (const int threads : {1, 2, 5}) {
    parallel::set_thread_count(threads);
    made.push_back(start);
    surface_fit::fit_surfaces(made.back(), m, {}, settings);
  }
  parallel::set_thread_count(2);
  for (const auto& c : made) {
    EXPECT_EQ(c.cells, made[0].cells);
    ASSERT_EQ(c.nodes_mm.size(), made[0].nodes_mm.size());
    EXPECT_EQ(std::memcmp(c.nodes_mm.data(), made[0].nodes_mm.data(), c.nodes_mm.size() * sizeof(Vec3)), 0);
  }
}

// Where a region ends in a tail beyond its end, distances to first order are small: only the labels tell.
TEST(Fit, TailsGoBackToTheirRegion) {
  const auto m = ball_of_two_halves();
  auto c = mesh_of(m).complex;
  const auto center = [&](std::size_t t) {
    const Cell& cell = c.cells[t];
    return 0.25 * (c.at(cell[0]) + c.at(cell[1]) + c.at(cell[2]) + c.at(cell[3]));
  };
  const auto is_stray = [&](std::size_t t) {  // a cell at the plane may have a little more on the other side of it
    constexpr double a_little = 0.1 * 0.9;
    return c.is_alive(static_cast<std::int32_t>(t)) && c.label[t] != m.label_at(center(t)) &&
           std::abs(center(t).z - 0.3) > a_little;
  };
  int strays = 0;
  for (std::size_t t = 0; t < c.cells.size(); ++t) {
    const Vec3 p = center(t);
    if (std::hypot(p.x - 0.1, p.y - 0.1) > 0.45 || p.z < 0.3 || p.z > 2.4) continue;
    c.label[t] = 2;
    strays += is_stray(t);
  }
  tetmesh::derive_touches(c);
  ASSERT_GT(strays, 4);
  EXPECT_EQ(surface_fit::fit_surfaces(c, m, {}, {}), 0);
  for (std::size_t t = 0; t < c.cells.size(); ++t) EXPECT_FALSE(is_stray(t)) << t;
  tetmesh::compress(c);
  EXPECT_EQ(defects(c), 0);
}

}  // namespace
