// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/nodes.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "model/mathematics.hpp"

namespace heartgen::distmesh {
namespace {

// The corners, edge and face middles of a cube, at distance 1.
std::vector<Vec3> directions_in_space() {
  std::vector<Vec3> directions;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0)
          directions.push_back(
              normalized(Vec3{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)}));
  return directions;
}

std::vector<Vec3> directions_in_plane() {
  constexpr int count = 16;
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    directions.push_back({math::cos(angle), math::sin(angle), 0});
  }
  return directions;
}

}  // namespace

LabelBits bits_at(const Materials& materials, const Vec3& point) {
  double farthest = 0;
  int side = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = materials.box_min_mm[axis] - point[axis], above = point[axis] - materials.box_max_mm[axis];
    if (below > farthest) {
      farthest = below;
      side = 2 * axis;
    }
    if (above > farthest) {
      farthest = above;
      side = 2 * axis + 1;
    }
  }
  return bit_of(side >= 0 ? tetmesh::first_side + side : materials.label_at(point));
}

LabelBits bits_around(const Materials& materials, Dimension dimension, const Vec3& point, double reach_mm) {
  static const auto in_plane = directions_in_plane(), in_space = directions_in_space();
  LabelBits found = bits_at(materials, point);
  for (const auto& direction : dimension == Dimension::two ? in_plane : in_space)
    found |= bits_at(materials, point + reach_mm * direction);
  return found;
}

}  // namespace heartgen::distmesh
