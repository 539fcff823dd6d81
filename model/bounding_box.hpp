// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The box around points.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

#include "model/vec.hpp"

namespace heartgen {

/// Lowest and highest corner; both zero without points.
inline std::pair<Vec3, Vec3> bounding_box(const std::vector<Vec3>& points) {
  if (points.empty()) return {};
  std::pair<Vec3, Vec3> box{points.front(), points.front()};
  for (const Vec3& p : points)
    for (int axis = 0; axis < 3; ++axis) {
      box.first[axis] = std::min(box.first[axis], p[axis]);
      box.second[axis] = std::max(box.second[axis], p[axis]);
    }
  return box;
}

inline double longest_side(const std::vector<Vec3>& points) {
  const auto [low, high] = bounding_box(points);
  return std::max({high.x - low.x, high.y - low.y, high.z - low.z});
}

}  // namespace heartgen
