// SPDX-License-Identifier: GPL-3.0-or-later
// The rotation within an affine pose: what it does to directions besides stretching.
#include <gtest/gtest.h>

#include <cmath>

#include "generator/atlas/register.hpp"

namespace heartgen {
namespace {

TEST(NearestRotation, OfARotationThatStretchesAlongAxesIsTheRotation) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Mat3 turn =
      Mat3{{Vec3{c, -s, 0}, Vec3{s, c, 0}, Vec3{0, 0, 1}}} * Mat3{{Vec3{1, 0, 0}, Vec3{0, c, -s}, Vec3{0, s, c}}};
  const Mat3 stretch{{Vec3{2e-3, 0, 0}, Vec3{0, 1.3e-3, 0}, Vec3{0, 0, 0.8e-3}}};
  const Mat3 found = atlas::nearest_rotation(turn * stretch);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) EXPECT_NEAR(found[row][column], turn[row][column], 1e-12);
}

}  // namespace
}  // namespace heartgen
