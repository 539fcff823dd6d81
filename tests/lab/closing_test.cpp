// SPDX-License-Identifier: GPL-3.0-or-later
// What closes gaps and what does not: the broken circle of thesis Fig 4.6, and a sphere with a hole.
#include <gtest/gtest.h>

#include <array>

#include "benchmarks/lab/broken_circle.hpp"
#include "generator/image/morphology.hpp"
#include "generator/pde/active_contours.hpp"
#include "generator/pde/subjective_surface.hpp"
#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::lab {
namespace {

using namespace testing;
using namespace pde;
using parallel::self;

const Closing& find(const std::vector<Closing>& all, const std::string& method) {
  return *std::find_if(all.begin(), all.end(), [&](const Closing& c) { return c.method == method; });
}

void expect_as_in_theory(const BrokenCircle& circle) {
  const auto all = close_broken_circle(circle);
  for (const char* method : {"snake_from_outside", "geometric_strong", "geodesic_from_outside", "subjective_surface"})
    EXPECT_TRUE(find(all, method).closed) << method << " " << find(all, method).end;
  EXPECT_EQ(find(all, "snake_from_inside").end, "collapsed");
  for (const char* method : {"snake_balloon", "geometric_weak"}) {
    EXPECT_FALSE(find(all, method).closed) << method;
    EXPECT_GT(find(all, method).outward_mm, closed_within_mm(circle)) << method;
  }
  for (const auto& closing : all) EXPECT_FALSE(closing.why.empty());
}

TEST(BrokenCircle, IsClosedByAllButTheSnakeFromInsideAndWeakBalloons) { expect_as_in_theory({}); }

TEST(BrokenCircle, AlsoWithOtherGapsAndALittleNoise) { expect_as_in_theory({70, 22, 3, 35, 3, 5}); }

TEST(SubjectiveSurface, StartsAtThePointOfView) {
  const auto grid = grid_of({21, 21, 1});
  const std::array<Vec3, 2> points{Vec3{10, 10, 0}, Vec3{14, 10, 0}};
  const auto start = point_of_view(grid, points);
  EXPECT_FLOAT_EQ(start(10, 10, 0), 1);
  EXPECT_FLOAT_EQ(start(12, 10, 0), 1.0F / 3);
  EXPECT_EQ(start(0, 10, 0), 0);
  EXPECT_EQ(start(10, 20, 0), 0);
  EXPECT_THROW(point_of_view(grid, {}), UserError);
  EXPECT_THROW(point_of_view(grid, std::array<Vec3, 1>{Vec3{30, 1, 0}}), UserError);
}

TEST(SubjectiveSurface, NeverLeavesItsRangeAndVanishesWithoutEdges) {
  const auto grid = grid_of({25, 23, 1});
  const std::array<Vec3, 1> point{Vec3{12, 11, 0}};
  const auto flat = subjective_surface(Volume<float>(grid, 5), point, {}, {2500, 0}, self());
  EXPECT_LT(flat.plateau, 0.01);  // every level set shrinks to a point within R² / 2
  EXPECT_FALSE(flat.steady);
  const auto image = noisy(ball(grid, 7), 0.3);
  const auto found = subjective_surface(image, point, {1, 0.05}, {400, 0}, self());
  EXPECT_GE(*std::ranges::min_element(found.surface.voxels), 0);
  EXPECT_LE(*std::ranges::max_element(found.surface.voxels), 1);
}

/// A sphere's shell of radius 11 and thickness 3 with a round hole at its top.
Volume<float> sphere_with_hole(const Grid& grid, double hole_mm) {
  return volume_of(grid, [&](double x, double y, double z) {
    const double ring = std::clamp(2 - std::abs(length(x, y, z) - 11), 0.0, 1.0);
    return z > 0 && length(x, y) < hole_mm ? 0 : 100 * ring;
  });
}

TEST(SubjectiveSurface, ClosesASphereWithAHole) {
  const auto grid = grid_of({36, 36, 30}, {1, 1, 1.2});
  const auto shell = sphere_with_hole(grid, 5);
  const std::array<Vec3, 1> seed{lps_from_index(grid, {17.5, 17.5, 14.5})};
  const auto found = subjective_surface(shell, seed, {1, 4}, {3000, 1e-3}, self());
  const Mask object = object_of(found, seed);
  const auto ball_volume = static_cast<double>(image::count(inside_of(balls(grid, seed, 9.5))));  // to its inside
  EXPECT_NEAR(static_cast<double>(image::count(object)) / ball_volume, 1, 0.2);
  const auto top = index_from_lps(grid, seed[0] + Vec3{0, 0, 15});
  EXPECT_EQ(object(std::lround(top.x), std::lround(top.y), std::lround(top.z)), 0);
}

TEST(GeometricContour, StaysInASphereWithAHoleOnlyIfItIsStiff) {
  // In 3D the cap in a hole of radius 5 has a curvature of 2 / 5 at most.
  const auto grid = grid_of({36, 36, 30}, {1, 1, 1.2});
  const std::array<Vec3, 1> seed{lps_from_index(grid, {17.5, 17.5, 14.5})};
  const auto outside = [&](double curvature) {
    const auto found = evolve_contour(sphere_with_hole(grid, 5), balls(grid, seed, 8), {1, 4},
                                      {ContourModel::geometric, curvature, 0, 1, 1500}, self());
    return inside_of(found.level_set)(2, 17, 14) == 1;
  };
  EXPECT_TRUE(outside(0.5));
  EXPECT_FALSE(outside(3.5));
}

TEST(SubjectiveSurface, HasTheSameBitsOnAnyNumberOfThreads) {
  const auto grid = grid_of({20, 18, 10}, {1, 1, 1.5});
  const auto image = noisy(ball(grid, 6), 0.2);
  const std::array<Vec3, 1> seed{lps_from_index(grid, {9, 8, 5})};
  const auto results = at_threads([&] {
    return subjective_surface(image, seed, {1, 0.1}, {100, 0}, self()).surface.voxels;
  });
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace heartgen::lab
