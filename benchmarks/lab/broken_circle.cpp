// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/broken_circle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "generator/image/components.hpp"
#include "generator/pde/active_contours.hpp"
#include "generator/pde/edge_function.hpp"
#include "generator/pde/snake.hpp"
#include "generator/pde/subjective_surface.hpp"
#include "model/mathematics.hpp"

namespace heartgen::lab {
namespace {

constexpr float ground = 255;  // the ring is 0
constexpr pde::EdgeSettings edges{1.5, 8};

pde::Point2 center_of(const BrokenCircle& c) {
  const double middle = 0.5 * (c.size - 1);
  return {middle, middle};
}

/// Coverage of a pixel by the ring, 16 samples.
double coverage(const BrokenCircle& c, double x, double y) {
  int hits = 0;
  for (const double dy : {-0.375, -0.125, 0.125, 0.375})
    for (const double dx : {-0.375, -0.125, 0.125, 0.375}) {
      const double px = x + dx, py = y + dy;
      const double turn = math::atan2(px, py) / (2 * std::numbers::pi) * c.gaps;  // one per gap, 0 at its middle
      const bool gap = c.gaps > 0 && std::abs(turn - std::round(turn)) < c.gap_deg / 720 * c.gaps;
      hits += !gap && std::abs(math::hypot(px, py) - c.radius_mm) < c.width_mm / 2;
    }
  return hits / 16.0;
}

/// Sum of three uniform numbers, the same everywhere.
double noise_of(std::mt19937& random) {
  double sum = 0;
  for (int n = 0; n < 3; ++n) sum += static_cast<double>(random()) / 4294967295.0 - 0.5;
  return 2 * sum;
}

/// Distance of the mask's border from the circle, inwards and outwards, along 720 rays.
void measure(const BrokenCircle& c, Closing& closing) {
  const pde::Point2 middle = center_of(c);
  Volume<float> soft(closing.inside.grid);
  std::ranges::copy(closing.inside.voxels, soft.voxels.begin());
  closing.inward_mm = c.radius_mm;
  closing.outward_mm = 0;
  double nearest = 1e30, farthest = 0;
  for (int ray = 0; ray < 720; ++ray) {
    const double angle = ray * std::numbers::pi / 360;
    double r = 0;
    for (int step = 0; step < 5 * c.size; ++step) {
      const double s = 0.1 * step;
      if (sample_linear(soft, {middle.x + s * math::sin(angle), middle.y + s * math::cos(angle), 0}) >= 0.5) r = s;
    }
    nearest = std::min(nearest, r);
    farthest = std::max(farthest, r);
  }
  closing.inward_mm = std::max(0.0, c.radius_mm - nearest);
  closing.outward_mm = std::max(0.0, farthest - c.radius_mm);
  const auto pieces = image::connected_components(closing.inside).voxel_count.size() - 1;
  closing.closed = pieces == 1 && closing.inward_mm < closed_within_mm(c) && closing.outward_mm < closed_within_mm(c);
}

/// Why a contour closes the gaps, or what it does instead.
std::string reason(const Closing& closing) {
  const bool is_snake = closing.method.starts_with("snake");
  if (closing.end == "collapsed")
    return "no edge within reach of the start: tension draws the curve together to a point";
  if (closing.end == "left the image" || closing.end == "filled the image")
    return is_snake ? "the balloon pushes the curve out through the gaps, tension is too weak to hold it"
                    : "the balloon passes the gaps: half their width is more than the weight of the curvature";
  if (!closing.closed) return "the contour did not settle on the circle";
  if (is_snake) return "starts around the circle: edges stop it, tension and rigidity span the gaps";
  if (closing.method.starts_with("geometric"))
    return "the front cannot bend enough to pass a gap: half its width is less than the weight of the curvature";
  if (closing.method.starts_with("geodesic")) return "edges hold the contour, the gaps are bridged by its shortest way";
  return "level sets pile up on the edges and bridge the gaps by their shortest way";
}

Closing snake(const BrokenCircle& c, const Volume<float>& h, const char* name, double start_mm, double balloon) {
  pde::SnakeSettings settings;
  settings.balloon = balloon;
  const auto found = pde::evolve_snake(pde::circle(center_of(c), start_mm, 64), h, settings);
  return {name, pde::name_of(found.end), false, 0, 0, found.iterations, "", pde::inside_of(found.curve, h.grid), {}};
}

Closing level_set(const BrokenCircle& c, const Volume<float>& image, const char* name, double start_mm,
                  const pde::ContourSettings& settings) {
  const auto [x, y] = center_of(c);
  const std::array<Vec3, 1> seed{Vec3{x, y, 0}};
  auto found = pde::evolve_contour(image, pde::balls(image.grid, seed, start_mm), edges, settings, parallel::self());
  return {name, pde::name_of(found.end), false, 0, 0, found.iterations, "", pde::inside_of(found.level_set), {}};
}

Closing subjective(const BrokenCircle& c, const Volume<float>& image) {
  const auto [x, y] = center_of(c);
  const std::array<Vec3, 1> seed{Vec3{x, y, 0}};
  auto found = pde::subjective_surface(image, seed, edges, {}, parallel::self());
  Mask object = pde::object_of(found, seed);
  return {"subjective_surface",
          found.steady ? "steady" : "out of iterations",
          false,
          0,
          0,
          found.iterations,
          "",
          std::move(object),
          std::move(found.surface)};
}

}  // namespace

Volume<float> draw(const BrokenCircle& c) {
  Grid grid;
  grid.size = {c.size, c.size, 1};
  Volume<float> image(grid);
  std::mt19937 random(4242);
  const auto [mx, my] = center_of(c);
  for (std::int64_t j = 0; j < c.size; ++j)
    for (std::int64_t i = 0; i < c.size; ++i) {
      const double ring = coverage(c, static_cast<double>(i) - mx, static_cast<double>(j) - my);
      image(i, j, 0) = ground * static_cast<float>(1 - ring) + static_cast<float>(c.noise * noise_of(random));
    }
  return image;
}

double closed_within_mm(const BrokenCircle& c) { return c.radius_mm * math::sin(c.gap_deg * std::numbers::pi / 360); }

std::vector<Closing> close_broken_circle(const BrokenCircle& c) {
  const Volume<float> image = draw(c);
  const auto h = parallel::gather(
      pde::edge_function(parallel::scatter(image, parallel::self()), edges, parallel::self()), parallel::self());
  const double outside = std::min(1.3 * c.radius_mm, 0.48 * c.size), inside = 0.4 * c.radius_mm;
  const double gap = 2 * closed_within_mm(c);
  std::vector<Closing> all;
  all.push_back(snake(c, h, "snake_from_outside", outside, 0));
  all.push_back(snake(c, h, "snake_from_inside", inside, 0));
  all.push_back(snake(c, h, "snake_balloon", inside, 1));
  all.push_back(level_set(c, image, "geometric_weak", inside, {pde::ContourModel::geometric, 0.1 * gap, 0, 1}));
  all.push_back(level_set(c, image, "geometric_strong", std::max(inside, 0.9 * gap),
                          {pde::ContourModel::geometric, 0.6 * gap, 0, 1}));
  all.push_back(level_set(c, image, "geodesic_from_outside", outside, {pde::ContourModel::geodesic, 1, 1, 0}));
  all.push_back(
      level_set(c, image, "geodesic_balloon", inside, {pde::ContourModel::geodesic, 0.6 * gap, 0.6 * gap, 1}));
  all.push_back(subjective(c, image));
  for (Closing& closing : all) {
    measure(c, closing);
    closing.why = reason(closing);
  }
  return all;
}

}  // namespace heartgen::lab
