// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Images that cost nothing to make: balls of blood in muscle, with noise.
#pragma once
#include <cstdint>

#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"
#include "model/volume.hpp"

namespace heartgen::benchmarks {

inline Grid grid_of(Index3 size, Vec3 spacing_mm = {0.5, 0.5, 1.2}) {
  Grid grid;
  grid.size = size;
  grid.spacing_mm = spacing_mm;
  return grid;
}

/// Grey values like a contrast CT's: balls of 300 on 50, noise of about 25 from a hash of the voxel's number.
inline Volume<float> test_image(const Grid& grid) {
  Volume<float> image(grid);
  const auto wave = [](std::int64_t i, double length_mm, double spacing) {
    return math::sin(6.283185307179586 * static_cast<double>(i) * spacing / length_mm);
  };
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const double shape =
              wave(i, 60, grid.spacing_mm.x) + wave(j, 60, grid.spacing_mm.y) + wave(k, 60, grid.spacing_mm.z);
          auto hash = static_cast<std::uint64_t>(grid.offset(i, j, k)) * 0x9E3779B97F4A7C15u;
          hash = (hash ^ (hash >> 29)) * 0xBF58476D1CE4E5B9u;
          const double noise = static_cast<double>(hash >> 40) / 16777216.0 - 0.5;
          image(i, j, k) = static_cast<float>((shape > 0.8 ? 300 : 50) + 90 * noise);
        }
  });
  return image;
}

}  // namespace heartgen::benchmarks
