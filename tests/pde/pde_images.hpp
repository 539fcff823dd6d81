// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Small images with known geometry for the tests of the PDE solvers.
#pragma once
#include <cmath>
#include <random>

#include "generator/parallel/slab.hpp"
#include "model/volume.hpp"

namespace heartgen::testing {

inline Grid grid_of(Index3 size, Vec3 spacing_mm = {1, 1, 1}) {
  Grid grid;
  grid.size = size;
  grid.spacing_mm = spacing_mm;
  return grid;
}

/// A volume of value(x, y, z), positions in mm from the centre of the grid.
template <class T = float, class Value>
Volume<T> volume_of(const Grid& grid, Value&& value) {
  Volume<T> volume(grid);
  const auto middle = [&](std::size_t axis) { return 0.5 * static_cast<double>(grid.size[axis] - 1); };
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        volume(i, j, k) = static_cast<T>(value((static_cast<double>(i) - middle(0)) * grid.spacing_mm.x,
                                               (static_cast<double>(j) - middle(1)) * grid.spacing_mm.y,
                                               (static_cast<double>(k) - middle(2)) * grid.spacing_mm.z));
  return volume;
}

/// Adds noise of the given standard deviation (a sum of uniform numbers), always the same.
inline Volume<float> noisy(Volume<float> image, double deviation) {
  std::mt19937 random(12345);
  for (auto& v : image.voxels) {
    double sum = 0;
    for (int n = 0; n < 3; ++n) sum += static_cast<double>(random()) / 4294967295.0 - 0.5;
    v += static_cast<float>(2 * deviation * sum);
  }
  return image;
}

inline double length(double x, double y, double z = 0) { return std::sqrt(x * x + y * y + z * z); }

/// A disc or ball of radius r_mm and value 1 on 0.
inline Volume<float> ball(const Grid& grid, double r_mm) {
  return volume_of(grid, [&](double x, double y, double z) { return length(x, y, z) < r_mm ? 1 : 0; });
}

template <class T>
parallel::Slab<T> slab_of(const Volume<T>& volume) {
  return parallel::scatter(volume, parallel::self());
}

/// Runs work() with 1, 2 and 3 threads and returns the three results.
template <class Work>
auto at_threads(Work&& work) {
  std::vector<std::invoke_result_t<Work>> results;
  for (const int threads : {1, 2, 3}) {
    parallel::set_thread_count(threads);
    results.push_back(work());
  }
  return results;
}

}  // namespace heartgen::testing
