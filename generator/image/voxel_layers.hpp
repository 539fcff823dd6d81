// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Layers of voxels around known ones, one voxel thick each. Not collective; deterministic.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::image {

/// Offsets of the 26 neighbours.
constexpr std::array<std::array<int, 3>, 26> neighbors26 = [] {
  std::array<std::array<int, 3>, 26> result{};
  std::size_t n = 0;
  for (int c = -1; c <= 1; ++c)
    for (int b = -1; b <= 1; ++b)
      for (int a = -1; a <= 1; ++a)
        if (a != 0 || b != 0 || c != 0) result[n++] = {a, b, c};
  return result;
}();

/// What the neighbours' numbers differ by from a voxel's own, in the same order.
std::array<std::int64_t, 26> neighbor_steps(const Grid& grid);

/// Whether a voxel has all its neighbours.
bool is_inner(const Grid& grid, std::int64_t voxel);

/// Numbers of the voxels with known != 0, ascending.
std::vector<std::int64_t> known_voxels(const Mask& known);

/// Unknown voxels that touch one of `around`, ascending, each once.
std::vector<std::int64_t> unknown_around(const Mask& known, const std::vector<std::int64_t>& around);

/// The same where every voxel that was found once is known from then on: `seen` has 1 for those, and gets it for the
/// new ones.
std::vector<std::int64_t> unseen_around(Mask& seen, const std::vector<std::int64_t>& around);

}  // namespace heartgen::image
