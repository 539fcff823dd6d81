// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/test_images.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/phantom/shapes.hpp"
#include "model/mathematics.hpp"

namespace heartgen::study {
namespace {

struct Spot {
  double x, y;
};

/// Share of a pixel inside a shape at this signed distance (pixels, negative inside).
double coverage(double distance) { return std::clamp(0.5 - distance, 0.0, 1.0); }

double capsule(Spot p, Spot a, Spot b, double radius) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double t = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return math::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy) - radius;
}

double ellipse(Spot p, Spot center, double rx, double ry) {
  const double x = (p.x - center.x) / rx, y = (p.y - center.y) / ry, r = math::hypot(x, y);
  return (r - 1) * std::min(rx, ry);
}

double box(Spot p, double left, double top, double right, double bottom) {
  return std::max({left - p.x, p.x - right, top - p.y, p.y - bottom});
}

/// Distance to a convex polygon, corners clockwise on the screen (exact inside, a lower bound outside its corners).
double polygon(Spot p, const std::vector<Spot>& corners) {
  double distance = -1e30;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const Spot &a = corners[n], &b = corners[(n + 1) % corners.size()];
    const double dx = b.x - a.x, dy = b.y - a.y;
    distance = std::max(distance, ((p.x - a.x) * dy - (p.y - a.y) * dx) / math::hypot(dx, dy));
  }
  return distance;
}

/// Smooth noise in [-1, 1]: random values on a lattice of the given pitch, blended.
double value_noise(Spot p, double pitch_x, double pitch_y, std::uint64_t key) {
  const double x = p.x / pitch_x, y = p.y / pitch_y;
  const double i = std::floor(x), j = std::floor(y);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const auto at = [&](double di, double dj) {
    const auto counter =
        static_cast<std::uint64_t>(static_cast<std::int64_t>(j + dj) * 4096 + static_cast<std::int64_t>(i + di));
    return phantom::random_symmetric(key, counter);
  };
  const double u = ease(x - i), v = ease(y - j);
  return (1 - v) * ((1 - u) * at(0, 0) + u * at(1, 0)) + v * ((1 - u) * at(0, 1) + u * at(1, 1));
}

/// Paints shapes one over another on a grey value; lengths are in units of 1/256 of the picture.
struct Brush {
  double grey;
  double pixels_per_unit;

  void operator()(double distance, double ink) { grey += coverage(distance * pixels_per_unit) * (ink - grey); }
};

double sky(Spot p) { return 205 - 0.16 * p.y + 7 * value_noise(p, 60, 25, 1) + 4 * value_noise(p, 22, 12, 2); }

double grass(Spot p) {
  return 152 + 14 * value_noise(p, 2.2, 5, 3) + 12 * value_noise(p, 14, 7, 4) + 0.1 * (p.y - 190);
}

void paint_skyline(Brush& brush, Spot p) {
  brush(box(p, 0, 160, 40, 190), 168);
  brush(box(p, 40, 148, 58, 190), 176);
  brush(box(p, 178, 140, 190, 190), 158);
  brush(box(p, 190, 156, 256, 190), 170);
  brush(box(p, 205, 118, 214, 190), 150);
  brush(capsule(p, {209.5, 100}, {209.5, 118}, 1), 150);
  for (int window = 0; window < 5; ++window) brush(box(p, 196.0 + 12 * window, 164, 200.0 + 12 * window, 172), 130);
}

void paint_tripod(Brush& brush, Spot p) {
  brush(capsule(p, {152, 100}, {132, 232}, 1.3), 35);
  brush(capsule(p, {152, 100}, {170, 236}, 1.3), 40);
  brush(capsule(p, {152, 100}, {190, 222}, 1.3), 45);
  brush(capsule(p, {142, 166}, {164, 166}, 0.8), 50);
  brush(box(p, 138, 80, 170, 98), 45);
  brush(ellipse(p, {146, 89}, 5, 5), 150);
  brush(box(p, 168, 84, 176, 94), 25);
}

void paint_man(Brush& brush, Spot p) {
  brush(polygon(p, {{88, 62}, {116, 62}, {126, 150}, {74, 170}}), 14);
  brush(capsule(p, {92, 160}, {84, 238}, 8), 22);
  brush(capsule(p, {112, 152}, {118, 240}, 8), 18);
  brush(capsule(p, {112, 74}, {132, 106}, 7), 10);
  brush(capsule(p, {132, 106}, {140, 94}, 5), 12);
  brush(ellipse(p, {142, 93}, 4, 4), 178);
  brush(ellipse(p, {108, 46}, 11, 14), 165);
  brush(polygon(p, {{92, 32}, {112, 26}, {118, 36}, {98, 56}}), 20);
  brush(polygon(p, {{104, 62}, {114, 62}, {112, 78}, {108, 78}}), 225);
  brush(capsule(p, {82, 242}, {96, 242}, 3), 30);
  brush(capsule(p, {116, 244}, {130, 244}, 3), 30);
}

double photographer_grey(Spot p, double pixels_per_unit) {
  const double horizon = 186 + 3 * value_noise(p, 40, 1e6, 5);
  Brush brush{sky(p), pixels_per_unit};
  paint_skyline(brush, p);
  brush(horizon - p.y, grass(p));
  paint_tripod(brush, p);
  paint_man(brush, p);
  return brush.grey;
}

bool in_shapes(Spot p) {
  const double ring = std::abs(math::hypot(p.x - 190, p.y - 66) - 36) - 9;
  const bool cross = box(p, 164, 182, 236, 200) < 0 || box(p, 191, 155, 209, 227) < 0;
  return ellipse(p, {64, 64}, 42, 42) < 0 || ring < 0 || cross || polygon(p, {{30, 226}, {72, 150}, {114, 226}}) < 0 ||
         box(p, 116, 100, 150, 134) < 0 || box(p, 20, 122, 104, 128) < 0 || box(p, 20, 236, 150, 246) < 0;
}

}  // namespace

Field photographer(int size) {
  Field image(size, size);
  const double pixels_per_unit = size / 256.0;
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const Spot p{(i + 0.5) / pixels_per_unit, (j + 0.5) / pixels_per_unit};
      const auto counter = static_cast<std::uint64_t>(j) * 65536 + static_cast<std::uint64_t>(i);
      const double noisy = photographer_grey(p, pixels_per_unit) + 5 * phantom::random_normal(6, counter);
      image(i, j) = std::clamp(std::round(noisy), 0.0, 255.0);
    }
  return image;
}

NoisyShapes noisy_shapes(int size, double probability) {
  NoisyShapes shapes{Field(size, size), PixelLabels(size, size)};
  const double pixels_per_unit = size / 256.0;
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      shapes.truth(i, j) = in_shapes({(i + 0.5) / pixels_per_unit, (j + 0.5) / pixels_per_unit});
      const auto counter = static_cast<std::uint64_t>(j) * 65536 + static_cast<std::uint64_t>(i);
      const bool replaced = phantom::random_symmetric(7, counter) < 2 * probability - 1;
      const double coin = phantom::random_symmetric(8, counter) < 0 ? 0 : 1;
      shapes.image(i, j) = replaced ? coin : shapes.truth(i, j);
    }
  return shapes;
}

FlatRegions bricks(int size) {
  FlatRegions result{Field(size, size), PixelLabels(size, size)};
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const double x = (i + 0.5) / size, y = (j + 0.5) / size;
      std::uint8_t region = 0;
      if (x < 0.5)
        region = y < 0.35 ? 0 : 1;
      else if (math::hypot(x - 0.75, y - 0.82) > 0.1)
        region = y < 0.65 ? 2 : 3;
      result.truth(i, j) = region;
      result.image(i, j) = 40 + 60 * region;
    }
  return result;
}

FlatRegions nested(int size) {
  FlatRegions result{Field(size, size), PixelLabels(size, size)};
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const double x = (i + 0.5) / size, y = (j + 0.5) / size;
      const std::uint8_t region = math::hypot(x - 0.55, y - 0.52) < 0.18         ? 2
                                  : math::hypot((x - 0.5) / 1.2, y - 0.5) < 0.36 ? 1
                                                                                 : 0;
      result.truth(i, j) = region;
      result.image(i, j) = 40 + 80 * region;
    }
  return result;
}

}  // namespace heartgen::study
