// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/atlas/standard_pose.hpp"

#include <array>
#include <cmath>

#include "model/axis_tensor.hpp"
#include "model/priors.hpp"

namespace heartgen::atlas {
namespace {

std::array<Vec3, 4> corners_of(const FiberAtlas& atlas, const Cell& cell) {
  std::array<Vec3, 4> p;
  for (std::size_t n = 0; n < 4; ++n) p[n] = atlas.points_mm[static_cast<std::size_t>(cell[n])];
  return p;
}

double volume_of(const std::array<Vec3, 4>& p) { return dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0])) / 6; }

Vec3 middle_of(const std::array<Vec3, 4>& p) { return (p[0] + p[1] + p[2] + p[3]) / 4; }

struct Mass {
  double volume_mm3 = 0;
  Vec3 center_mm;
  AxisTensor spread;  ///< mean of the dyads of positions seen from the centre, mm^2
};

Mass mass_of(const FiberAtlas& atlas) {
  Mass mass;
  for (const Cell& cell : atlas.cells) {
    const auto p = corners_of(atlas, cell);
    mass.volume_mm3 += volume_of(p);
    mass.center_mm += volume_of(p) * middle_of(p);
  }
  mass.center_mm = mass.center_mm / mass.volume_mm3;
  for (const Cell& cell : atlas.cells) {
    auto p = corners_of(atlas, cell);
    const double share = volume_of(p) / mass.volume_mm3;
    Vec3 sum;
    for (Vec3& corner : p) {
      corner = corner - mass.center_mm;
      sum += corner;
      mass.spread += share / 20 * axis_tensor(corner);
    }
    mass.spread += share / 20 * axis_tensor(sum);
  }
  return mass;
}

/// Of the two directions of an axis the one in which the muscle reaches farther (its third moment is positive).
Vec3 to_farther_end(const FiberAtlas& atlas, const Mass& mass, const Vec3& axis) {
  double third = 0;
  for (const Cell& cell : atlas.cells) {
    const auto p = corners_of(atlas, cell);
    const double t = dot(middle_of(p) - mass.center_mm, axis);
    third += volume_of(p) * t * t * t;
  }
  return third < 0 ? -axis : axis;
}

}  // namespace

FiberAtlas in_standard_pose(const FiberAtlas& atlas) {
  const Mass mass = mass_of(atlas);
  AxisTensor lack = -1.0 * mass.spread;  // its leading axis is that of the least spread
  for (std::size_t c = 0; c < 3; ++c) lack.c[c] += trace(mass.spread);
  const Vec3 first = to_farther_end(atlas, mass, leading_axis(mass.spread));
  const Vec3 third = leading_axis(lack);
  const Vec3 second = to_farther_end(atlas, mass, normalized(cross(third, first)));
  const Mat3 rotation{{first, second, cross(first, second)}};
  const double scale = priors::adult_heart_rms_mm / std::sqrt(trace(mass.spread));
  FiberAtlas result = atlas;
  for (Vec3& p : result.points_mm) p = scale * (rotation * (p - mass.center_mm));
  for (Vec3& f : result.fiber) f = rotation * f;
  for (Vec3& f : result.cell_fiber) f = rotation * f;
  return result;
}

}  // namespace heartgen::atlas
