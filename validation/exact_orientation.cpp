// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/exact_orientation.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace heartgen::validation {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon() / 2;

/// The exact sum of doubles as parts that do not overlap, small ones first (Shewchuk's grow-expansion).
template <std::size_t Capacity>
struct ExactSum {
  std::array<double, Capacity> parts;
  std::size_t count = 0;

  void add(double value) {
    double carry = value;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double sum = carry + parts[i];
      const double virtual_part = sum - carry;
      const double rest = (carry - (sum - virtual_part)) + (parts[i] - virtual_part);
      carry = sum;
      if (rest != 0) parts[kept++] = rest;
    }
    if (carry != 0) parts[kept++] = carry;
    count = kept;
  }
  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  void add_product(double a, double b, double c) {
    const double product = a * b;
    add_product(std::fma(a, b, -product), c);
    add_product(product, c);
  }
  int sign() const { return count == 0 ? 0 : parts[count - 1] > 0 ? 1 : -1; }
};

int sign_of(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

template <std::size_t Capacity>
void add_determinant(ExactSum<Capacity>& sum, double sign, const Vec3& u, const Vec3& v, const Vec3& w) {
  sum.add_product(sign * u.x, v.y, w.z);
  sum.add_product(-sign * u.x, v.z, w.y);
  sum.add_product(sign * u.y, v.z, w.x);
  sum.add_product(-sign * u.y, v.x, w.z);
  sum.add_product(sign * u.z, v.x, w.y);
  sum.add_product(-sign * u.z, v.y, w.x);
}

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  ExactSum<96> sum;  // 24 products of three numbers, four parts each
  add_determinant(sum, 1, b, c, d);
  add_determinant(sum, -1, a, c, d);
  add_determinant(sum, 1, a, b, d);
  add_determinant(sum, -1, a, b, c);
  return sum.sign();
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double determinant = dot(u, cross(v, w));
  const double magnitude = std::abs(u.x) * (std::abs(v.y * w.z) + std::abs(v.z * w.y)) +
                           std::abs(u.y) * (std::abs(v.z * w.x) + std::abs(v.x * w.z)) +
                           std::abs(u.z) * (std::abs(v.x * w.y) + std::abs(v.y * w.x));
  constexpr double bound = (8 + 64 * epsilon) * epsilon;  // of the rounding of differences, products and sums
  if (std::abs(determinant) > bound * magnitude) return sign_of(determinant);
  if (magnitude == 0) return 0;
  return exact_orientation(a, b, c, d);
}

int orientation_along(int axis, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double left = (b[i] - a[i]) * (c[j] - a[j]), right = (b[j] - a[j]) * (c[i] - a[i]);
  constexpr double bound = (3 + 16 * epsilon) * epsilon;
  if (std::abs(left - right) > bound * (std::abs(left) + std::abs(right))) return sign_of(left - right);
  ExactSum<16> sum;
  sum.add_product(b[i], c[j]);
  sum.add_product(-b[j], c[i]);
  sum.add_product(c[i], a[j]);
  sum.add_product(-c[j], a[i]);
  sum.add_product(a[i], b[j]);
  sum.add_product(-a[j], b[i]);
  return sum.sign();
}

}  // namespace heartgen::validation
