// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/study/length.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "model/mathematics.hpp"

namespace heartgen::study {
namespace {

/// Forward differences of f, 0 across the border.
double forward_x(const Field& f, int i, int j) { return i + 1 < f.width ? f(i + 1, j) - f(i, j) : 0; }
double forward_y(const Field& f, int i, int j) { return j + 1 < f.height ? f(i, j + 1) - f(i, j) : 0; }
double backward_x(const Field& f, int i, int j) { return i > 0 ? f(i, j) - f(i - 1, j) : 0; }
double backward_y(const Field& f, int i, int j) { return j > 0 ? f(i, j) - f(i, j - 1) : 0; }

bool crosses(double a, double b) { return (a >= 0) != (b >= 0); }

/// Smereka's weight of one neighbour: |neighbour D0| / (|difference| |∇0|), 0 without a change of sign.
double smereka_weight(double here, double there, double central, double norm) {
  return crosses(here, there) ? std::abs(there * central) / (std::abs(there - here) * norm) : 0;
}

struct Point {
  double x, y;
};

/// The point of the edge a-b at which the linear interpolation is 0; `va` and `vb` differ in sign.
Point zero_point(Point a, double va, Point b, double vb) {
  const double t = va / (va - vb);
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

double segment_in_triangle(const std::array<Point, 3>& p, const std::array<double, 3>& v) {
  for (std::size_t tip = 0; tip < 3; ++tip) {
    const std::size_t a = (tip + 1) % 3, b = (tip + 2) % 3;
    if (!crosses(v[tip], v[a]) || !crosses(v[tip], v[b])) continue;
    const Point from = zero_point(p[tip], v[tip], p[a], v[a]), to = zero_point(p[tip], v[tip], p[b], v[b]);
    return math::hypot(from.x - to.x, from.y - to.y);
  }
  return 0;
}

}  // namespace

double gaussian_delta(double x, double beta) {
  return math::exp(-(x / beta) * (x / beta)) / (beta * std::sqrt(std::numbers::pi));
}

double gaussian_delta_slope(double x, double beta) { return -2 * x / (beta * beta) * gaussian_delta(x, beta); }

double gaussian_length(const Field& phi, double beta, double spacing) {
  double sum = 0;
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i)
      sum += gaussian_delta(phi(i, j), beta) * math::hypot(forward_x(phi, i, j), forward_y(phi, i, j));
  return spacing * sum;
}

EdgeCrossings edge_crossings(const Field& phi) {
  EdgeCrossings found;
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) {
      const bool x = i + 1 < phi.width && crosses(phi(i, j), phi(i + 1, j));
      const bool y = j + 1 < phi.height && crosses(phi(i, j), phi(i, j + 1));
      found.edges += static_cast<int>(x) + static_cast<int>(y);
      found.corners += x && y;
    }
  return found;
}

double heaviside_length(const Field& phi, double spacing) {
  const EdgeCrossings found = edge_crossings(phi);
  return spacing * (static_cast<double>(found.edges) - (2 - std::numbers::sqrt2) * static_cast<double>(found.corners));
}

double smereka_length(const Field& phi, double spacing, double epsilon) {
  double sum = 0;
  for (int j = 0; j < phi.height; ++j)
    for (int i = 0; i < phi.width; ++i) {
      const double here = phi(i, j), ahead_x = forward_x(phi, i, j), behind_x = backward_x(phi, i, j);
      const double ahead_y = forward_y(phi, i, j), behind_y = backward_y(phi, i, j);
      const double x = (ahead_x + behind_x) / 2, y = (ahead_y + behind_y) / 2;
      const double norm = std::sqrt(x * x + y * y + epsilon * spacing * spacing);
      sum += smereka_weight(here, here + ahead_x, x, norm) + smereka_weight(here, here - behind_x, x, norm) +
             smereka_weight(here, here + ahead_y, y, norm) + smereka_weight(here, here - behind_y, y, norm);
    }
  return spacing * sum;
}

double piecewise_linear_length(const Field& phi, double spacing) {
  double sum = 0;
  for (int j = 0; j + 1 < phi.height; ++j)
    for (int i = 0; i + 1 < phi.width; ++i) {
      const double a = phi(i, j), b = phi(i + 1, j), c = phi(i + 1, j + 1), d = phi(i, j + 1);
      sum += segment_in_triangle({Point{0, 0}, {1, 0}, {1, 1}}, {a, b, c}) +
             segment_in_triangle({Point{0, 0}, {1, 1}, {0, 1}}, {a, c, d});
    }
  return spacing * sum;
}

}  // namespace heartgen::study
