// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Small fixed-size vectors: points and directions in LPS millimetres.
#pragma once
#include <array>
#include <cmath>

namespace heartgen {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  constexpr double operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  constexpr double& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr Vec3 operator*(const Vec3& a, double s) { return s * a; }
constexpr Vec3 operator/(const Vec3& a, double s) { return (1 / s) * a; }
constexpr Vec3& operator+=(Vec3& a, const Vec3& b) { return a = a + b; }
constexpr Vec3& operator-=(Vec3& a, const Vec3& b) { return a = a - b; }
constexpr Vec3& operator*=(Vec3& a, double s) { return a = s * a; }

constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// Unit vector along `a`, or zero where `a` is shorter than 1e-300.
inline Vec3 normalized(const Vec3& a) {
  const double length = norm(a);
  return length > 1e-300 ? a / length : Vec3{};
}

/// Row-major 3×3 matrix.
struct Mat3 {
  std::array<Vec3, 3> rows{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  constexpr const Vec3& operator[](int i) const { return rows[static_cast<std::size_t>(i)]; }
  constexpr Vec3& operator[](int i) { return rows[static_cast<std::size_t>(i)]; }
  friend constexpr bool operator==(const Mat3&, const Mat3&) = default;
};

constexpr Vec3 operator*(const Mat3& m, const Vec3& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
constexpr Mat3 transposed(const Mat3& m) {
  return {{Vec3{m[0].x, m[1].x, m[2].x}, Vec3{m[0].y, m[1].y, m[2].y}, Vec3{m[0].z, m[1].z, m[2].z}}};
}
constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
  const Mat3 t = transposed(b);
  return {{Vec3{dot(a[0], t[0]), dot(a[0], t[1]), dot(a[0], t[2])},
           Vec3{dot(a[1], t[0]), dot(a[1], t[1]), dot(a[1], t[2])},
           Vec3{dot(a[2], t[0]), dot(a[2], t[1]), dot(a[2], t[2])}}};
}
constexpr double determinant(const Mat3& m) { return dot(m[0], cross(m[1], m[2])); }

}  // namespace heartgen
