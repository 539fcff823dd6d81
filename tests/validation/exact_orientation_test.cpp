// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/exact_orientation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using namespace heartgen;
using validation::orientation;
using validation::orientation_along;

TEST(ExactOrientation, PlainCells) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};
  EXPECT_EQ(orientation(a, b, c, d), 1);
  EXPECT_EQ(orientation(a, c, b, d), -1);
  EXPECT_EQ(orientation(a, b, c, {5, 7, 0}), 0);
}

TEST(ExactOrientation, OneUlpDecides) {
  // Far from the origin, where differences round.
  const Vec3 shift{12345.678, -9876.54321, 555.5};
  const Vec3 a = shift, b = shift + Vec3{1.0 / 3, 0.1, 0.7}, c = shift + Vec3{0.2, 1.0 / 7, -0.4};
  for (const double direction : {1.0, -1.0}) {
    Vec3 d = a;
    d.z = std::nextafter(d.z, direction * std::numeric_limits<double>::infinity());
    const double normal_z = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    EXPECT_EQ(orientation(a, b, c, d), (normal_z > 0 ? 1 : -1) * static_cast<int>(direction));
  }
  EXPECT_EQ(orientation(a, b, c, a), 0);
  EXPECT_EQ(orientation(a, b, c, b), 0);
}

TEST(ExactOrientation, SignsArePermutationsAndExactZerosStayZero) {
  // Multiples of 0.1 are not representable: only exact arithmetic on what they round to is consistent.
  std::uint32_t state = 1;
  const auto number = [&] {
    state = state * 1664525U + 1013904223U;
    return 0.1 * static_cast<double>((state >> 20) % 7);
  };
  int zeros = 0;
  for (int i = 0; i < 3000; ++i) {
    Vec3 p[4];
    for (auto& q : p) q = {number(), number(), number()};
    const int sign = orientation(p[0], p[1], p[2], p[3]);
    EXPECT_EQ(orientation(p[1], p[0], p[2], p[3]), -sign);
    EXPECT_EQ(orientation(p[1], p[2], p[0], p[3]), sign);
    EXPECT_EQ(orientation(p[3], p[1], p[2], p[0]), -sign);
    EXPECT_EQ(orientation(p[2], p[3], p[0], p[1]), sign);
    zeros += sign == 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int turn = orientation_along(axis, p[0], p[1], p[2]);
      EXPECT_EQ(orientation_along(axis, p[1], p[2], p[0]), turn);
      EXPECT_EQ(orientation_along(axis, p[1], p[0], p[2]), -turn);
    }
  }
  EXPECT_GT(zeros, 10) << "the case was not met";
}

TEST(ExactOrientation, AlongAnAxis) {
  EXPECT_EQ(orientation_along(2, {0, 0, 5}, {1, 0, -3}, {0, 1, 9}), 1);
  EXPECT_EQ(orientation_along(0, {5, 0, 0}, {-3, 1, 0}, {9, 0, 1}), 1);
  EXPECT_EQ(orientation_along(1, {0, 5, 0}, {0, -3, 1}, {1, 9, 0}), 1);
  EXPECT_EQ(orientation_along(2, {0, 0, 0}, {0.1, 0.1, 0}, {0.3, 0.3, 0}), 0);
}

}  // namespace
