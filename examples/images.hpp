// SPDX-License-Identifier: GPL-3.0-or-later
// What the examples work on, and how they end.
#pragma once
#include <cstdint>
#include <cstdio>
#include <heartgen/images.hpp>

/// A grid of n x n x slices voxels of 1 mm.
inline heartgen::Grid grid_of(std::int64_t n, std::int64_t slices) {
  heartgen::Grid grid;
  grid.size = {n, n, slices};
  return grid;
}

/// How far a voxel lies from the middle of its image, mm.
inline double radius_at(const heartgen::Grid& grid, std::int64_t i, std::int64_t j, std::int64_t k) {
  const heartgen::Vec3 middle = heartgen::lps_from_index(
      grid, {0.5 * static_cast<double>(grid.size[0] - 1), 0.5 * static_cast<double>(grid.size[1] - 1),
             0.5 * static_cast<double>(grid.size[2] - 1)});
  const heartgen::Vec3 here =
      heartgen::lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
  return heartgen::norm(here - middle);
}

/// Bright inside the radius (a disc in one slice, else a ball), dark outside, with noise that is the same every time.
inline heartgen::Volume<float> noisy_ball(const heartgen::Grid& grid, double radius_mm, float noise) {
  heartgen::Volume<float> image(grid);
  std::uint32_t state = 1;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        state = 1664525 * state + 1013904223;
        const float random = static_cast<float>(state >> 8) / static_cast<float>(1 << 24) - 0.5F;
        image(i, j, k) = (radius_at(grid, i, j, k) < radius_mm ? 100.F : 0.F) + noise * random;
      }
  return image;
}

inline double count(const heartgen::Mask& mask) {
  double voxels = 0;
  for (const auto value : mask.voxels) voxels += value;
  return voxels;
}

/// Prints a figure beside what it should be; 1 where it lies farther from that than the share allows.
inline int expect_near(const char* what, double found, double wanted, double share) {
  std::printf("%s: %.4g (should be %.4g)\n", what, found, wanted);
  const double error = found > wanted ? found - wanted : wanted - found;
  return error <= share * (wanted > 0 ? wanted : -wanted) ? 0 : 1;
}
