// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh of thin cells, improved: the surface keeps its faces, the worst angle grows.
#include <algorithm>
#include <array>
#include <cmath>
#include <heartgen/improve.hpp>
#include <numbers>

#include "images.hpp"

namespace {

using namespace heartgen;

double min_dihedral_deg(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells) {
  double least = 180;
  for (const auto& cell : cells) {
    std::array<Vec3, 4> normal;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto at = [&](std::size_t n) { return nodes[static_cast<std::size_t>(cell[(i + n) % 4])]; };
      normal[i] = normalized(cross(at(2) - at(1), at(3) - at(1)));
      if (dot(normal[i], at(0) - at(1)) > 0) normal[i] = -normal[i];
    }
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j)
        least =
            std::min(least, 180 - std::acos(std::clamp(dot(normal[i], normal[j]), -1.0, 1.0)) * 180 / std::numbers::pi);
  }
  return least;
}

}  // namespace

int main() {
  // Cubes of six cells each, the nodes inside pushed about.
  constexpr std::int32_t n = 6;
  std::vector<Vec3> nodes;
  std::vector<Cell> cells;
  std::uint32_t state = 7;
  const auto random = [&] {
    return static_cast<double>((state = 1664525 * state + 1013904223) >> 8) / (1 << 24) - 0.5;
  };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const bool is_inside = i % n != 0 && j % n != 0 && k % n != 0;
        const double push = is_inside ? 0.45 : 0;
        nodes.push_back({i + push * random(), j + push * random(), k + push * random()});
      }
  const std::array<std::array<int, 3>, 6> orders{{{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  const std::array<std::int32_t, 3> step{1, n + 1, (n + 1) * (n + 1)};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (const auto& order : orders) {
          Cell cell{i * step[0] + j * step[1] + k * step[2], 0, 0, 0};
          for (std::size_t e = 0; e < 3; ++e) cell[e + 1] = cell[e] + step[static_cast<std::size_t>(order[e])];
          cells.push_back(cell);
        }
  const auto better = improve_mesh(nodes, cells, {}, {.goal_deg = 25});
  const double before = min_dihedral_deg(nodes, cells), after = min_dihedral_deg(better.nodes_mm, better.cells);
  std::printf("smallest dihedral angle: %.1f degrees, then %.1f; surface %s\n", before, after,
              better.is_fixed ? "unchanged" : "moved");
  return after > before && better.is_fixed ? 0 : 1;
}
