// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Boxes along the axes, around points and faces.
#pragma once
#include <algorithm>
#include <array>

#include "generator/tetmesh/complex.hpp"
#include "model/contract.hpp"

namespace heartgen::tetmesh {

/// The corners belong to it.
struct Box {
  Vec3 low, high;
  void add(const Vec3& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  bool contains(const Vec3& p) const {
    return low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y && low.z <= p.z && p.z <= high.z;
  }
  bool meets(const Box& o) const {
    return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y && low.z <= o.high.z &&
           o.low.z <= high.z;
  }
};

/// Around some points, at least one.
template <class Points>
Box box_around(const Points& points) {
  HEARTGEN_EXPECTS(std::begin(points) != std::end(points));
  Box box{*points.begin(), *points.begin()};
  for (const Vec3& p : points) box.add(p);
  return box;
}

inline Box box_of(const Complex& complex, const Face& face) {
  return box_around(std::array{complex.at(face[0]), complex.at(face[1]), complex.at(face[2])});
}

}  // namespace heartgen::tetmesh
