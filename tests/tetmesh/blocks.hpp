// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Meshes to be improved: blocks of cubes of six cells each, with regions, shaken inside.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::testing {

struct Block {
  std::vector<Vec3> nodes;
  std::vector<Cell> cells;
  std::vector<std::int32_t> region;
  int n = 0;

  bool on_border(std::size_t node) const {
    const Vec3& p = nodes[node];
    const double end = n;
    return p.x == 0 || p.y == 0 || p.z == 0 || p.x == end || p.y == end || p.z == end;
  }
};

/// n × n × n cubes of size 1; region 5 below z = cut, 7 above.
inline Block block(int n, int cut = 0) {
  Block b;
  b.n = n;
  const auto id = [n](int i, int j, int k) { return static_cast<std::int32_t>((k * (n + 1) + j) * (n + 1) + i); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) b.nodes.push_back({double(i), double(j), double(k)});
  constexpr int paths[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};  // corners between 0 and 7
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (const auto& path : paths) {
          const auto corner = [&](int bits) { return id(i + (bits & 1), j + ((bits >> 1) & 1), k + (bits >> 2)); };
          b.cells.push_back({corner(0), corner(path[0]), corner(path[1]), corner(7)});
          b.region.push_back(k < cut ? 5 : 7);
        }
  return b;
}

/// Numbers in [-1, 1), always the same.
struct Shaking {
  std::uint32_t state = 12345;
  double next() {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8) / 8388608.0 - 1;
  }
};

/// Moves the nodes that `moves` accepts by up to `amplitude` along each axis.
template <class Moves>
void shake(Block& b, double amplitude, std::uint32_t seed, const Moves& moves) {
  Shaking noise{seed};
  for (std::size_t i = 0; i < b.nodes.size(); ++i) {
    const Vec3 by{noise.next(), noise.next(), noise.next()};
    if (moves(i)) b.nodes[i] += amplitude * by;
  }
}

/// The cube blown up to a ball of radius n / 2.
inline void round_off(Block& b) {
  const double half = 0.5 * b.n;
  for (auto& p : b.nodes) {
    const Vec3 d = p - Vec3{half, half, half};
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    p = Vec3{half, half, half} + (norm(d) > 0 ? largest / norm(d) : 0) * d;
  }
}

inline double volume(const std::vector<Vec3>& nodes, const Cell& c) {
  const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(c[i])]; };
  return dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) / 6;
}

}  // namespace heartgen::testing
