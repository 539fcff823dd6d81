// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Building blocks of the phantom: signed distances (mm, negative inside) of ellipsoids, tubes and plates, smooth
/// unions, tables over height, and the counter-based random numbers that make variants and noise.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "model/vec.hpp"

namespace heartgen::phantom {

/// Union of two distances, rounded where they differ by less than `k` mm (quadratic blend; exact elsewhere).
inline double smooth_min(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k * 0.25;
}
inline double smooth_max(double a, double b, double k) { return -smooth_min(-a, -b, k); }

/// 0 below `from`, 1 above `to`, smooth between.
inline double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Distance to an axis-aligned ellipsoid at the origin: exact at the surface, first order away from it.
inline double ellipsoid(const Vec3& p, const Vec3& r) {
  const Vec3 a{p.x / r.x, p.y / r.y, p.z / r.z};
  const Vec3 b{a.x / r.x, a.y / r.y, a.z / r.z};
  const double k0 = norm(a), k1 = norm(b);
  return k1 > 1e-9 ? k0 * (k0 - 1) / k1 : -std::min({r.x, r.y, r.z});
}

/// Distance to a straight piece with a linearly changing radius and round ends.
double round_cone(const Vec3& p, const Vec3& a, const Vec3& b, double ra, double rb);

/// Distance to a flat triangle of the given half thickness.
double thick_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, double half_thickness);

/// A half space as a distance: negative on the side that `normal` points away from.
struct Plane {
  Vec3 point;
  Vec3 normal;
  double operator()(const Vec3& p) const { return dot(p - point, normal); }
};

struct CurvePoint {
  Vec3 at;
  double radius = 0;
};

/// Interpolates control points by a Catmull-Rom spline, `pieces` straight pieces per span.
std::vector<CurvePoint> smooth_curve(const std::vector<CurvePoint>& control, int pieces = 6);

/// A set of straight pieces with radii, looked up through a grid of cubes. The distance is capped at `reach_mm`:
/// beyond it the value is exactly `reach_mm`, which is what makes the look-up cheap.
class Tube {
 public:
  Tube() = default;
  Tube(std::vector<CurvePoint> curve, double reach_mm);

  void add(const CurvePoint& from, const CurvePoint& to);
  /// Builds the look-up; call once after the last `add`.
  void finish(double reach_mm);
  double operator()(const Vec3& p) const;
  Vec3 nearest_direction(const Vec3& p) const;  ///< unit direction of the nearest piece
  const std::vector<CurvePoint>& curve() const { return curve_; }

 private:
  struct Piece {
    Vec3 a, ab;
    double inverse_length2, ra, taper;  // taper: rb - ra
    double distance(const Vec3& p) const {
      const Vec3 ap = p - a;
      const double t = std::clamp(dot(ap, ab) * inverse_length2, 0.0, 1.0);
      return norm(ap - t * ab) - (ra + t * taper);
    }
  };
  struct CellRange {
    int from[3], to[3];
  };
  CellRange cells_near(const Piece& piece) const;
  std::size_t cell_index(int i, int j, int k) const {
    const int index = (k * count_[1] + j) * count_[0] + i;
    return static_cast<std::size_t>(index);
  }
  void enter(std::size_t id, std::vector<std::vector<std::int32_t>>& cells) const;
  std::vector<CurvePoint> curve_;
  std::vector<Piece> pieces_;
  double reach_mm_ = 0, cube_mm_ = 10;
  Vec3 low_;
  int count_[3] = {0, 0, 0};
  std::vector<std::int32_t> start_, list_;
};

/// A smooth function of height through given points (monotone cubic), constant beyond the ends; tabulated every
/// millimetre and interpolated linearly.
class HeightTable {
 public:
  HeightTable() = default;
  HeightTable(const std::vector<double>& z, const std::vector<double>& value);
  double operator()(double height) const {
    const double place = std::clamp(height - low_, 0.0, static_cast<double>(samples_.size() - 2) + 0.999999);
    const auto i = static_cast<std::size_t>(place);
    return samples_[i] + (place - static_cast<double>(i)) * (samples_[i + 1] - samples_[i]);
  }

 private:
  double low_ = 0;
  std::vector<double> samples_{0, 0};
};

/// 64 well-mixed bits of a key and a counter: the same everywhere, in any order.
std::uint64_t random_bits(std::uint64_t key, std::uint64_t counter);
/// Uniform in [-1, 1).
double random_symmetric(std::uint64_t key, std::uint64_t counter);
/// Standard normal to 5 sigma (sum of eight 16-bit uniforms: integer arithmetic only, hence the same bits everywhere).
float random_normal(std::uint64_t key, std::uint64_t counter);

}  // namespace heartgen::phantom
