// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/voxel_layers.hpp"

#include <algorithm>

namespace heartgen::image {

std::vector<std::int64_t> known_voxels(const Mask& known) {
  std::vector<std::int64_t> result;
  for (std::size_t v = 0; v < known.voxels.size(); ++v)
    if (known.voxels[v]) result.push_back(static_cast<std::int64_t>(v));
  return result;
}

std::array<std::int64_t, 26> neighbor_steps(const Grid& grid) {
  std::array<std::int64_t, 26> steps{};
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const auto& s = neighbors26[n];
    steps[n] = s[0] + grid.size[0] * (s[1] + grid.size[1] * s[2]);
  }
  return steps;
}

bool is_inner(const Grid& grid, std::int64_t voxel) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = voxel % grid.size[axis];
    if (at == 0 || at + 1 == grid.size[axis]) return false;
    voxel /= grid.size[axis];
  }
  return true;
}

std::vector<std::int64_t> unseen_around(Mask& seen, const std::vector<std::int64_t>& around) {
  const Grid& g = seen.grid;
  const auto steps = neighbor_steps(g);
  std::vector<std::int64_t> result;
  const auto visit = [&](std::int64_t at) {
    auto& mark = seen.voxels[static_cast<std::size_t>(at)];
    if (mark) return;
    mark = 1;
    result.push_back(at);
  };
  for (const auto v : around) {
    if (is_inner(g, v)) {
      for (const auto step : steps) visit(v + step);
      continue;
    }
    const std::int64_t i = v % g.size[0], j = v / g.size[0] % g.size[1], k = v / (g.size[0] * g.size[1]);
    for (std::size_t n = 0; n < steps.size(); ++n)
      if (const auto& s = neighbors26[n]; g.contains(i + s[0], j + s[1], k + s[2])) visit(v + steps[n]);
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<std::int64_t> unknown_around(const Mask& known, const std::vector<std::int64_t>& around) {
  Mask seen = known;
  return unseen_around(seen, around);
}

}  // namespace heartgen::image
