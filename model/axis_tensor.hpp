// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Directions without a sign as dyads f f^T: they can be added and averaged, which the vectors themselves cannot.
#pragma once
#include <array>
#include <cmath>

#include "model/vec.hpp"

namespace heartgen {

struct AxisTensor {
  std::array<double, 6> c{};  ///< xx yy zz xy xz yz

  AxisTensor& operator+=(const AxisTensor& o) {
    for (std::size_t i = 0; i < 6; ++i) c[i] += o.c[i];
    return *this;
  }
  friend AxisTensor operator*(double s, AxisTensor t) {
    for (double& x : t.c) x *= s;
    return t;
  }
  friend AxisTensor operator+(AxisTensor a, const AxisTensor& b) { return a += b; }
};

inline AxisTensor axis_tensor(const Vec3& f) {
  return {{f.x * f.x, f.y * f.y, f.z * f.z, f.x * f.y, f.x * f.z, f.y * f.z}};
}

inline double trace(const AxisTensor& t) { return t.c[0] + t.c[1] + t.c[2]; }

/// An axis as the vector whose component of largest magnitude is positive.
inline Vec3 with_unique_sign(const Vec3& axis) {
  int largest = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(axis[i]) > std::abs(axis[largest])) largest = i;
  return axis[largest] < 0 ? -axis : axis;
}

/// leading_axis of any tensor, by Jacobi rotations.
inline Vec3 leading_axis_by_rotations(const AxisTensor& t) {
  double a[3][3] = {{t.c[0], t.c[3], t.c[4]}, {t.c[3], t.c[1], t.c[5]}, {t.c[4], t.c[5], t.c[2]}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int sweep = 0; sweep < 12; ++sweep) {
    const double off = std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]);
    const double diagonal = std::abs(a[0][0]) + std::abs(a[1][1]) + std::abs(a[2][2]);
    if (off <= 1e-17 * diagonal) break;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double tangent = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double cosine = 1 / std::sqrt(tangent * tangent + 1), sine = tangent * cosine;
        for (int k = 0; k < 3; ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = cosine * x - sine * y;
          a[k][q] = sine * x + cosine * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = cosine * x - sine * y;
          a[q][k] = sine * x + cosine * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = v[k][p], y = v[k][q];
          v[k][p] = cosine * x - sine * y;
          v[k][q] = sine * x + cosine * y;
        }
      }
  }
  int best = 0;
  for (int i = 1; i < 3; ++i)
    if (a[i][i] > a[best][best]) best = i;
  if (a[best][best] <= 0) return {};
  return with_unique_sign(normalized({v[0][best], v[1][best], v[2][best]}));
}

/// Unit eigenvector of the largest eigenvalue (zero for the zero tensor); its sign is made unique.
/// Where that eigenvalue stands clear of the next one, as in nearly all means of fibres, it is the largest root of
/// x^3 - 3 x - 2 r, to which Newton's method falls from x = 2 (the tensor is m + p B with B free of a trace, r half the
/// determinant of B); else by rotations.
inline Vec3 leading_axis(const AxisTensor& t) {
  constexpr double clear = -0.5;    // r is -1 where the two largest eigenvalues are one, 1 where the two others are
  constexpr double uneven = 1e-20;  // squared: below, the tensor is a multiple of the identity but for rounding
  constexpr int max_steps = 8;      // r = clear needs five
  const double m = trace(t) / 3;
  Vec3 diagonal{t.c[0] - m, t.c[1] - m, t.c[2] - m}, rest{t.c[3], t.c[4], t.c[5]};  // xx yy zz, xy xz yz
  const double p2 = (dot(diagonal, diagonal) + 2 * dot(rest, rest)) / 6;
  if (!(p2 > uneven * m * m)) return leading_axis_by_rotations(t);
  const double p = std::sqrt(p2);
  diagonal = diagonal / p;
  rest = rest / p;
  const double r =
      0.5 * (diagonal.x * (diagonal.y * diagonal.z - rest.z * rest.z) -
             rest.x * (rest.x * diagonal.z - rest.z * rest.y) + rest.y * (rest.x * rest.z - diagonal.y * rest.y));
  if (!(r > clear)) return leading_axis_by_rotations(t);
  double x = 2;
  for (int step = 0; step < max_steps; ++step) {
    const double lower = x - (x * (x * x - 3) - 2 * r) / (3 * (x * x - 1));
    if (!(lower < x)) break;
    x = lower;
  }
  if (m + p * x <= 0) return {};
  // Rows of B - x are across the axis: the longest product of two of them is the most accurate.
  const Vec3 rows[3] = {
      {diagonal.x - x, rest.x, rest.y}, {rest.x, diagonal.y - x, rest.z}, {rest.y, rest.z, diagonal.z - x}};
  Vec3 longest = cross(rows[0], rows[1]);
  for (const Vec3& other : {cross(rows[0], rows[2]), cross(rows[1], rows[2])})
    if (dot(other, other) > dot(longest, longest)) longest = other;
  return with_unique_sign(normalized(longest));
}

}  // namespace heartgen
