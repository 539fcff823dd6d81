// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/snake.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/pde/cyclic_pentadiagonal.hpp"
#include "generator/pde/spacing.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::pde {
namespace {

constexpr std::size_t min_points = 8;
constexpr int steps_between_checks = 50;

Point2 operator+(const Point2& a, const Point2& b) { return {a.x + b.x, a.y + b.y}; }
Point2 operator-(const Point2& a, const Point2& b) { return {a.x - b.x, a.y - b.y}; }
Point2 operator*(double s, const Point2& a) { return {s * a.x, s * a.y}; }
double cross(const Point2& a, const Point2& b) { return a.x * b.y - a.y * b.x; }
double dot(const Point2& a, const Point2& b) { return a.x * b.x + a.y * b.y; }
double norm(const Point2& a) { return math::hypot(a.x, a.y); }

void check(const Curve& start, const Volume<float>& h, const SnakeSettings& s) {
  if (h.grid.size[2] != 1 || h.grid.size[0] < 3 || h.grid.size[1] < 3)
    throw UserError("a snake lives in a 2D image", "snake", "give one slice");
  if (start.size() < min_points) throw UserError("the snake has too few points", "snake", "give 8 at least");
  if (!(s.tension_mm >= 0) || !(s.rigidity_mm3 >= 0) || !(s.attraction_mm >= 0) || !std::isfinite(s.balloon))
    throw UserError("tension, rigidity and attraction must not be negative", "snake", "0 leaves a term out");
  if (!(s.spacing_mm >= 0)) throw UserError("the spacing must not be negative", "snake", "0: the pixel spacing");
  if (s.max_iterations < 0) throw UserError("iterations must not be negative", "snake", "");
}

bool in_image(const Point2& p, const Grid& grid) {
  return p.x >= 0 && p.y >= 0 && p.x <= static_cast<double>(grid.size[0] - 1) * grid.spacing_mm.x &&
         p.y <= static_cast<double>(grid.size[1] - 1) * grid.spacing_mm.y;
}

/// ∇h by central differences, one component per pixel; interpolated where it is needed, so that it is continuous.
struct Gradient {
  Volume<float> x, y;
};

Gradient gradient_of(const Volume<float>& h) {
  Gradient g{Volume<float>(h.grid), Volume<float>(h.grid)};
  const auto [nx, ny, nz] = h.grid.size;
  for (std::int64_t j = 0; j < ny; ++j)
    for (std::int64_t i = 0; i < nx; ++i) {
      const auto l = std::max<std::int64_t>(i - 1, 0), r = std::min(i + 1, nx - 1);
      const auto f = std::max<std::int64_t>(j - 1, 0), b = std::min(j + 1, ny - 1);
      g.x(i, j, 0) = static_cast<float>(0.5 / h.grid.spacing_mm.x) * (h(r, j, 0) - h(l, j, 0));
      g.y(i, j, 0) = static_cast<float>(0.5 / h.grid.spacing_mm.y) * (h(i, b, 0) - h(i, f, 0));
    }
  return g;
}

double value_at(const Volume<float>& volume, const Point2& p) {
  return sample_linear(volume, {p.x / volume.grid.spacing_mm.x, p.y / volume.grid.spacing_mm.y, 0});
}

int points_for(const Curve& curve, double spacing) {
  return std::max(static_cast<int>(min_points), static_cast<int>(std::lround(length_mm(curve) / spacing)));
}

/// Steps that the explicit part (edges a pixel wide, the balloon) bears.
double step_for(const SnakeSettings& s, double pixel) {
  const double bend = std::max(s.tension_mm, s.attraction_mm);
  double step = 1e30;
  if (bend > 0) step = std::min(step, 0.25 * pixel * pixel / bend);
  if (s.balloon != 0) step = std::min(step, 0.25 * pixel / std::abs(s.balloon));
  if (s.rigidity_mm3 > 0 && bend == 0) step = std::min(step, 0.25 * math::pow(pixel, 4) / s.rigidity_mm3);
  return step < 1e30 ? step : 1;
}

/// One semi-implicit step of a curve with equal distances between its points.
void advance(Curve& curve, const Volume<float>& h, const Gradient& g, const SnakeSettings& s, double step) {
  const std::size_t n = curve.size();
  std::vector<double> x(n), y(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Point2& p = curve[i];
    Point2 force = -s.attraction_mm * Point2{value_at(g.x, p), value_at(g.y, p)};
    if (s.balloon != 0) {
      const Point2 along = curve[(i + 1) % n] - curve[(i + n - 1) % n];
      const double size = std::max(norm(along), 1e-12);
      force = force + s.balloon * value_at(h, p) / size * Point2{along.y, -along.x};
    }
    x[i] = p.x + step * force.x;
    y[i] = p.y + step * force.y;
  }
  const double ds = length_mm(curve) / static_cast<double>(n), a = step * s.tension_mm / (ds * ds);
  const double b = step * s.rigidity_mm3 / (ds * ds * ds * ds);
  solve_cyclic({1 + 2 * a + 6 * b, -a - 4 * b, b}, {&x, &y});
  for (std::size_t i = 0; i < n; ++i) curve[i] = {x[i], y[i]};
}

double distance_to_segment(const Point2& p, const Point2& a, const Point2& b) {
  const Point2 along = b - a;
  const double t = std::clamp(dot(p - a, along) / std::max(dot(along, along), 1e-300), 0.0, 1.0);
  return norm(p - (a + t * along));
}

/// How far the points of a curve lie from another curve.
double farthest(const Curve& points, const Curve& from) {
  double result = 0;
  for (const Point2& p : points) {
    double nearest = 1e30;
    for (std::size_t i = 0; i < from.size(); ++i)
      nearest = std::min(nearest, distance_to_segment(p, from[i], from[(i + 1) % from.size()]));
    result = std::max(result, nearest);
  }
  return result;
}

bool segments_cross(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  return (cross(b - a, c - a) > 0) != (cross(b - a, d - a) > 0) &&
         (cross(d - c, a - c) > 0) != (cross(d - c, b - c) > 0);
}

/// Catmull-Rom between b and c, t in [0, 1].
Point2 between(const Point2& a, const Point2& b, const Point2& c, const Point2& d, double t) {
  const double t2 = t * t, t3 = t2 * t;
  return 0.5 * ((-t + 2 * t2 - t3) * a + (2 - 5 * t2 + 3 * t3) * b + (t + 4 * t2 - 3 * t3) * c + (t3 - t2) * d);
}

}  // namespace

const char* name_of(SnakeEnd end) {
  switch (end) {
    case SnakeEnd::settled:
      return "settled";
    case SnakeEnd::collapsed:
      return "collapsed";
    case SnakeEnd::left_the_image:
      return "left the image";
    case SnakeEnd::crossed_itself:
      return "crossed itself";
    case SnakeEnd::out_of_iterations:
      break;
  }
  return "out of iterations";
}

Curve circle(const Point2& center_mm, double radius_mm, int points) {
  Curve curve;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * std::numbers::pi * i / points;
    curve.push_back(center_mm + radius_mm * Point2{math::cos(angle), math::sin(angle)});
  }
  return curve;
}

double length_mm(const Curve& curve) {
  double sum = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) sum += norm(curve[(i + 1) % curve.size()] - curve[i]);
  return sum;
}

double area_mm2(const Curve& curve) {
  double sum = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) sum += cross(curve[i], curve[(i + 1) % curve.size()]);
  return sum / 2;
}

bool crosses_itself(const Curve& curve) {
  const std::size_t n = curve.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      if (segments_cross(curve[i], curve[i + 1], curve[j], curve[(j + 1) % n])) return true;
    }
  return false;
}

Curve resampled(const Curve& curve, int points) {
  const std::size_t n = curve.size();
  const double spacing = length_mm(curve) / points;
  Curve result{curve.front()};
  double begin = 0;  // arc length at the segment's start
  for (std::size_t i = 0; i < n && result.size() < static_cast<std::size_t>(points); ++i) {
    const double size = norm(curve[(i + 1) % n] - curve[i]);
    while (result.size() < static_cast<std::size_t>(points)) {
      const double wanted = spacing * static_cast<double>(result.size());
      if (wanted > begin + size) break;
      const double t = size > 0 ? (wanted - begin) / size : 0;
      result.push_back(between(curve[(i + n - 1) % n], curve[i], curve[(i + 1) % n], curve[(i + 2) % n], t));
    }
    begin += size;
  }
  while (result.size() < static_cast<std::size_t>(points)) result.push_back(curve.back());
  return result;
}

SnakeResult evolve_snake(const Curve& start, const Volume<float>& h, const SnakeSettings& settings) {
  check(start, h, settings);
  const double pixel = smallest_spacing(h.grid);
  const double spacing = settings.spacing_mm > 0 ? settings.spacing_mm : pixel;
  const double step = step_for(settings, pixel);
  const Gradient gradient = gradient_of(h);
  SnakeResult result{resampled(start, points_for(start, spacing)), SnakeEnd::out_of_iterations, 0, 0};
  Curve before = result.curve;
  for (; result.iterations < settings.max_iterations; ++result.iterations) {
    if (result.iterations > 0 && result.iterations % steps_between_checks == 0) {
      if (farthest(result.curve, before) < settings.tolerance_mm) {
        result.end = SnakeEnd::settled;
        break;
      }
      before = result.curve;
    }
    advance(result.curve, h, gradient, settings, step);
    if (!std::ranges::all_of(result.curve, [&](const Point2& p) { return in_image(p, h.grid); })) {
      result.end = SnakeEnd::left_the_image;
      break;
    }
    if (length_mm(result.curve) < static_cast<double>(min_points) * spacing) {
      result.end = SnakeEnd::collapsed;
      break;
    }
    result.curve = resampled(result.curve, points_for(result.curve, spacing));
  }
  result.time = result.iterations * step;
  if (result.end != SnakeEnd::collapsed && crosses_itself(result.curve)) result.end = SnakeEnd::crossed_itself;
  return result;
}

Mask inside_of(const Curve& curve, const Grid& slice) {
  Mask mask(slice);
  for (std::int64_t j = 0; j < slice.size[1]; ++j) {
    const double y = static_cast<double>(j) * slice.spacing_mm.y;
    std::vector<double> crossings;
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const Point2 &a = curve[i], &b = curve[(i + 1) % curve.size()];
      if ((a.y <= y) != (b.y <= y)) crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::ranges::sort(crossings);
    for (std::size_t c = 0; c + 1 < crossings.size(); c += 2)
      for (std::int64_t i = 0; i < slice.size[0]; ++i) {
        const double x = static_cast<double>(i) * slice.spacing_mm.x;
        if (x >= crossings[c] && x < crossings[c + 1]) mask(i, j, 0) = 1;
      }
  }
  return mask;
}

}  // namespace heartgen::pde
