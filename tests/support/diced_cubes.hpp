// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Cubes cut into six tetrahedra each along the paths from one corner to the opposite one (Kuhn): conforming, dihedral
/// angles of 45, 60 and 90 degrees.
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::testing {

/// The (n + 1)³ corners of n × n × n unit cubes, x fastest.
inline std::vector<Vec3> cube_corners(int n) {
  std::vector<Vec3> corners;
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        corners.push_back({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
  return corners;
}

/// Calls add(cell, i, j, k) for the six cells, of positive volume, of every cube (i, j, k).
template <class Add>
void dice_cubes(int n, Add&& add) {
  const auto id = [n](const std::array<int, 3>& at) {
    return static_cast<std::int32_t>((at[2] * (n + 1) + at[1]) * (n + 1) + at[0]);
  };
  constexpr std::array<std::array<std::size_t, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (std::size_t order = 0; order < orders.size(); ++order) {
          std::array<int, 3> at{i, j, k};
          Cell cell{id(at), 0, 0, 0};
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[orders[order][step]];
            cell[step + 1] = id(at);
          }
          if (order >= 3) std::swap(cell[2], cell[3]);
          add(cell, i, j, k);
        }
}

}  // namespace heartgen::testing
