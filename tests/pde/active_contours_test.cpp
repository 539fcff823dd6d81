// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/active_contours.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "generator/image/components.hpp"
#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen {
namespace {

using namespace testing;
using namespace pde;
using parallel::self;
using std::numbers::pi;

Vec3 center_of(const Grid& grid) {
  return lps_from_index(grid, {0.5 * static_cast<double>(grid.size[0] - 1), 0.5 * static_cast<double>(grid.size[1] - 1),
                               0.5 * static_cast<double>(grid.size[2] - 1)});
}

LevelSet ball_of(const Grid& grid, double radius, const Vec3& shift = {}) {
  const std::array<Vec3, 1> center{center_of(grid) + shift};
  return balls(grid, center, radius);
}

/// Radius of the disc or ball with the volume inside, to sub-voxel accuracy.
double radius_of(const LevelSet& phi) {
  const Grid& grid = phi.grid;
  const bool flat = grid.size[2] == 1;
  double volume = 0;
  for (const float v : phi.voxels) volume += std::clamp(0.5 - static_cast<double>(v) / grid.spacing_mm.x, 0.0, 1.0);
  volume *= flat ? grid.spacing_mm.x * grid.spacing_mm.y : grid.voxel_volume_mm3();
  return flat ? std::sqrt(volume / pi) : std::cbrt(volume * 3 / (4 * pi));
}

ContourResult without_edges(const LevelSet& start, ContourSettings settings) {
  settings.tolerance = 0;
  return evolve_contour(slab_of(start), slab_of(Volume<float>(start.grid, 1)), settings, self());
}

TEST(ActiveContour, CurvatureShrinksCirclesAndSpheresAsInTheClosedForm) {
  for (const auto model : {ContourModel::geometric, ContourModel::geodesic}) {
    const auto disc = without_edges(ball_of(grid_of({64, 64, 1}), 22), {model, 0.7, 0.7, 0, 500});
    EXPECT_NEAR(radius_of(parallel::gather(disc.level_set, self())), std::sqrt(22 * 22 - 2 * 0.7 * disc.time), 0.15);
    const auto ball = without_edges(ball_of(grid_of({40, 40, 30}, {1, 1, 1.3}), 15), {model, 1, 1, 0, 150});
    EXPECT_NEAR(radius_of(parallel::gather(ball.level_set, self())), std::sqrt(15 * 15 - 4 * ball.time), 0.15);
    EXPECT_GT(ball.time, 10);
  }
}

TEST(ActiveContour, BalloonMovesAtItsSpeed) {
  const auto grown =
      without_edges(ball_of(grid_of({64, 64, 1}, {0.5, 0.5, 1}), 5), {ContourModel::geometric, 0, 0, 1.5, 30});
  EXPECT_NEAR(radius_of(parallel::gather(grown.level_set, self())), 5 + 1.5 * grown.time, 0.2);
  const auto shrunk = without_edges(ball_of(grid_of({64, 64, 1}), 25), {ContourModel::geodesic, 0, 0, -1, 30});
  EXPECT_NEAR(radius_of(parallel::gather(shrunk.level_set, self())), 25 - shrunk.time, 0.2);
}

TEST(ActiveContour, GeodesicContourFindsADiscToAFractionOfAPixel) {
  const auto grid = grid_of({72, 72, 1});
  const auto disc = volume_of(
      grid, [](double x, double y, double) { return 200 * std::clamp(20.3 - length(x - 0.3, y) + 0.5, 0.0, 1.0); });
  for (const double noise : {0.0, 15.0})
    for (const bool from_outside : {true, false}) {
      LevelSet start = ball_of(grid, from_outside ? 29 : 14, {2, -2, 0});
      ContourSettings settings;
      if (!from_outside) {  // from within the balloon brings it to the edge, and on to the far side of it
        settings.balloon = 0.3;
        start = evolve_contour(noisy(disc, noise), start, {1.5, 12}, settings, self()).level_set;
        settings.balloon = 0;
      }
      const auto found = evolve_contour(noisy(disc, noise), start, {1.5, 12}, settings, self());
      EXPECT_EQ(found.end, ContourEnd::settled) << noise << from_outside;
      // Without a balloon it rests where (r h)' = 0, 0.07 inside this edge.
      EXPECT_NEAR(radius_of(found.level_set), 20.3 - 0.07, noise > 0 ? 0.3 : 0.15) << noise << from_outside;
      const Mask inside = inside_of(found.level_set);
      double x = 0, n = 0;
      for (std::int64_t j = 0; j < 72; ++j)
        for (std::int64_t i = 0; i < 72; ++i)
          if (inside(i, j, 0)) x += static_cast<double>(i), n += 1;
      EXPECT_NEAR(x / n, 35.5 + 0.3, 0.15);
    }
}

TEST(ActiveContour, FrontsMergeAndPart) {
  const auto grid = grid_of({60, 40, 1});
  const std::array<Vec3, 2> seeds{Vec3{18, 20, 0}, Vec3{42, 20, 0}};
  const auto pieces = [&](const ContourResult& result) {
    return image::connected_components(inside_of(parallel::gather(result.level_set, self()))).voxel_count.size() - 1;
  };
  const LevelSet two = balls(grid, seeds, 9);
  EXPECT_EQ(pieces(without_edges(two, {ContourModel::geometric, 0, 0, 1, 20})), 1U);
  const LevelSet joined = balls(grid, seeds, 13);
  EXPECT_EQ(pieces(without_edges(joined, {ContourModel::geometric, 0, 0, -1, 20})), 2U);
}

TEST(ActiveContour, GapsStopTheGeometricContourByTheirWidth) {
  // A wall with a gap of 16 voxels between two rooms; the front that has to pass bends like a disc of radius 8.
  const auto grid = grid_of({80, 60, 1});
  auto h = volume_of(grid, [](double x, double y, double) { return std::abs(x) < 2 && std::abs(y) > 8 ? 0 : 1; });
  const auto leaks = [&](double curvature, bool on_edges) {
    ContourSettings settings{ContourModel::geometric, curvature, 0, 1, 6000};
    settings.curvature_on_edges = on_edges;
    const auto found = evolve_contour(slab_of(ball_of(grid, 18, {-20, 0, 0})), slab_of(h), settings, self());
    return inside_of(parallel::gather(found.level_set, self()))(75, 30, 0) == 1;
  };
  EXPECT_TRUE(leaks(0.7 * 8, false));
  EXPECT_FALSE(leaks(1.3 * 8, false));
  EXPECT_TRUE(leaks(1.3 * 8, true));  // nothing holds the front against its own curvature in the wall
}

TEST(ActiveContour, SaysHowItEnded) {
  const auto start = ball_of(grid_of({30, 30, 1}), 6);
  const auto h = slab_of(Volume<float>(start.grid, 1));
  EXPECT_EQ(evolve_contour(slab_of(start), h, {}, self()).end, ContourEnd::vanished);
  ContourSettings growing;
  growing.balloon = 2;
  EXPECT_EQ(evolve_contour(slab_of(start), h, growing, self()).end, ContourEnd::filled_the_image);
  growing.max_iterations = 10;
  EXPECT_EQ(evolve_contour(slab_of(start), h, growing, self()).end, ContourEnd::out_of_iterations);
}

TEST(ActiveContour, HasTheSameBitsOnAnyNumberOfThreads) {
  const auto grid = grid_of({24, 20, 12}, {1, 1, 1.5});
  const auto image = noisy(ball(grid, 7), 0.2);
  for (const auto model : {ContourModel::geometric, ContourModel::geodesic}) {
    const auto results = at_threads([&] {
      return evolve_contour(image, ball_of(grid, 4), {1, 0.1}, {model, 1, 1, 0.5, 60}, self()).level_set.voxels;
    });
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
  }
}

TEST(ActiveContour, MistakesAreUserErrors) {
  const auto grid = grid_of({20, 20, 1});
  const auto h = slab_of(Volume<float>(grid, 1));
  const auto start = slab_of(ball_of(grid, 4));
  EXPECT_THROW(evolve_contour(start, h, {ContourModel::geodesic, -1}, self()), UserError);
  EXPECT_THROW(evolve_contour(start, h, {ContourModel::geometric, 0, 0, 0}, self()), UserError);
  EXPECT_THROW(evolve_contour(slab_of(LevelSet(grid, 1)), h, {}, self()), UserError);
  EXPECT_THROW(evolve_contour(Volume<float>(grid), ball_of(grid_of({9, 9, 1}), 3), {}, {}, self()), UserError);
  const std::array<Vec3, 1> outside{Vec3{50, 0, 0}};
  EXPECT_THROW(balls(grid, outside, 3), UserError);
  EXPECT_THROW(balls(grid, {}, 3), UserError);
  EXPECT_THROW(balls(grid, std::array<Vec3, 1>{Vec3{5, 5, 0}}, 0), UserError);
}

}  // namespace
}  // namespace heartgen
