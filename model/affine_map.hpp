// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Affine maps of space.
#pragma once
#include "model/vec.hpp"

namespace heartgen {

/// y = matrix * x + offset_mm
struct AffineMap {
  Mat3 matrix;
  Vec3 offset_mm;
  Vec3 operator()(const Vec3& x) const { return matrix * x + offset_mm; }
};

inline AffineMap inverse(const AffineMap& map) {
  const Mat3& m = map.matrix;
  const double det = determinant(m);
  const Vec3 a = cross(m[1], m[2]) / det, b = cross(m[2], m[0]) / det, c = cross(m[0], m[1]) / det;
  AffineMap result;
  result.matrix = transposed(Mat3{{a, b, c}});
  result.offset_mm = -(result.matrix * map.offset_mm);
  return result;
}

}  // namespace heartgen
