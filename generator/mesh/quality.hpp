// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The quality that mesh improvement maximises.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "model/vec.hpp"

namespace heartgen::mesh {

/// Smallest sine of the six dihedral angles, signed like the volume: 0 for flat cells, 0.94 for the regular one.
/// sin = 3 V l / (2 A1 A2) for the edge of length l between faces of areas A1 and A2.
inline double min_sine(const std::array<Vec3, 4>& p) {
  const Vec3 e01 = p[1] - p[0], e02 = p[2] - p[0], e03 = p[3] - p[0];
  const Vec3 e12 = p[2] - p[1], e13 = p[3] - p[1], e23 = p[3] - p[2];
  const double six_volumes = dot(e01, cross(e02, e03));
  // Twice the areas of the faces opposite to each node; edge ij lies between the faces opposite to the other two.
  const double a0 = norm(cross(e12, e13)), a1 = norm(cross(e02, e03));
  const double a2 = norm(cross(e01, e03)), a3 = norm(cross(e01, e02));
  const double result = six_volumes * std::min({norm(e01) / (a2 * a3), norm(e02) / (a1 * a3), norm(e03) / (a1 * a2),
                                                norm(e12) / (a0 * a3), norm(e13) / (a0 * a2), norm(e23) / (a0 * a1)});
  return std::isfinite(result) ? result : 0;
}

}  // namespace heartgen::mesh
