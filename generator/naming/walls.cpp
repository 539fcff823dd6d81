// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/naming/walls.hpp"

#include <algorithm>
#include <cmath>

#include "generator/chest/working_image.hpp"
#include "generator/image/isotropic_distance.hpp"
#include "generator/parallel/threads.hpp"
#include "model/quantile.hpp"

namespace heartgen::naming {
namespace {

/// A row of a ball: `half` voxels to both sides at (j, k).
struct BallRow {
  std::int64_t j, k, half;
};

std::vector<BallRow> ball_rows(double radius_voxels) {
  std::vector<BallRow> rows;
  const auto reach = static_cast<std::int64_t>(radius_voxels);
  for (std::int64_t k = -reach; k <= reach; ++k)
    for (std::int64_t j = -reach; j <= reach; ++j) {
      const double rest = radius_voxels * radius_voxels - static_cast<double>(j * j + k * k);
      if (rest >= 0) rows.push_back({j, k, static_cast<std::int64_t>(std::sqrt(rest))});
    }
  return rows;
}

/// Row-wise extremes within `half` voxels to both sides.
template <class Pick>
Volume<float> row_extremes(const Volume<float>& image, std::int64_t half, Pick pick) {
  Volume<float> result(image.grid);
  const auto nx = image.grid.size[0];
  parallel::parallel_for(0, image.grid.size[1] * image.grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t row = begin; row < end; ++row) {
      const float* const from = image.voxels.data() + row * nx;
      float* const to = result.voxels.data() + row * nx;
      for (std::int64_t i = 0; i < nx; ++i) {
        float best = from[i];
        for (std::int64_t n = std::max<std::int64_t>(i - half, 0); n <= std::min(i + half, nx - 1); ++n)
          best = pick(best, from[n]);
        to[i] = best;
      }
    }
  });
  return result;
}

/// The extreme value within a ball around each voxel.
template <class Pick>
Volume<float> ball_extremes(const Volume<float>& image, double radius_mm, Pick pick) {
  const auto rows = ball_rows(radius_mm / image.grid.spacing_mm.x);
  std::vector<Volume<float>> within;
  for (std::int64_t half = 0; half <= static_cast<std::int64_t>(radius_mm / image.grid.spacing_mm.x); ++half)
    within.push_back(row_extremes(image, half, pick));
  const auto [nx, ny, nz] = image.grid.size;
  Volume<float> result = image;
  parallel::parallel_for(0, nz, [&, nx = nx, ny = ny, nz = nz](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < ny; ++j)
        for (const auto& row : rows) {
          if (j + row.j < 0 || j + row.j >= ny || k + row.k < 0 || k + row.k >= nz) continue;
          const float* const from = &within[static_cast<std::size_t>(row.half)](0, j + row.j, k + row.k);
          float* const to = &result(0, j, k);
          for (std::int64_t i = 0; i < nx; ++i) to[i] = pick(to[i], from[i]);
        }
  });
  return result;
}

constexpr auto greater = [](float a, float b) { return a > b ? a : b; };
constexpr auto lesser = [](float a, float b) { return a < b ? a : b; };

/// Standard deviation of what smoothing takes away from the blood.
double noise_of(const Scene& scene, const Levels& levels) {
  constexpr double brighter_hu = 20, sigma_per_deviation = 1.48;
  std::vector<float> deviations;
  for (std::size_t v = 0; v < scene.hu.voxels.size(); ++v)
    if (scene.room.voxels[v] && static_cast<double>(scene.smooth.voxels[v]) > levels.muscle_hu + brighter_hu)
      deviations.push_back(std::abs(scene.hu.voxels[v] - scene.smooth.voxels[v]));
  return deviations.empty() ? 0 : sigma_per_deviation * static_cast<double>(upper_median(deviations));
}

Mask find_valleys(const Scene& scene, const Levels& levels, double noise_hu) {
  constexpr double widest_mm = 6, brightest_share = 1.05, darker_share = 0.62, least_hu = 18, of_noise = 1.5;
  const auto closed = grey_closing(scene.smooth, widest_mm);
  const double least_depth = std::max(least_hu, of_noise * noise_hu);
  return chest::mask_where(scene.smooth.grid, [&](const Vec3&, std::size_t v) {
    const auto hu = static_cast<double>(scene.smooth.voxels[v]);
    const double around = std::min(static_cast<double>(closed.voxels[v]), brightest_share * levels.blood_hu);
    return hu < levels.muscle_hu + darker_share * (around - levels.muscle_hu) && around - hu > least_depth;
  });
}

Volume<float> steepness_of(const Volume<float>& image) {
  Volume<float> result(image.grid);
  const auto [nx, ny, nz] = image.grid.size;
  parallel::parallel_for(0, nz, [&, nx = nx, ny = ny](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < ny; ++j)
        for (std::int64_t i = 0; i < nx; ++i)
          result(i, j, k) = static_cast<float>(norm(image::gradient_at(image, i, j, k)));
  });
  return result;
}

/// Steeper than on both sides along the gradient, and steep at all.
Mask find_ridges(const Volume<float>& image, const Volume<float>& steepness, const Mask& room, double least) {
  Mask ridge(image.grid);
  const auto [nx, ny, nz] = image.grid.size;
  parallel::parallel_for(0, nz, [&, nx = nx, ny = ny](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < ny; ++j)
        for (std::int64_t i = 0; i < nx; ++i) {
          const auto here = static_cast<double>(steepness(i, j, k));
          if (here <= least || !room(i, j, k)) continue;
          const Vec3 uphill = normalized(image::gradient_at(image, i, j, k));
          const Vec3 at{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          ridge(i, j, k) =
              here >= sample_linear(steepness, at + uphill) && here >= sample_linear(steepness, at - uphill);
        }
  });
  return ridge;
}

}  // namespace

Volume<float> grey_closing(const Volume<float>& image, double radius_mm) {
  return ball_extremes(ball_extremes(image, radius_mm, greater), radius_mm, lesser);
}

Walls find_walls(const Scene& scene, const Levels& levels) {
  constexpr double least_hu_per_mm = 9, per_mm_of_noise = 0.2, per_mm_of_contrast = 0.03;
  constexpr double flat_share = 0.6, below_muscle_hu = 30;
  Walls walls;
  walls.noise_hu = noise_of(scene, levels);
  walls.valley = find_valleys(scene, levels, walls.noise_hu);
  const double edge =
      std::max({least_hu_per_mm, per_mm_of_noise * walls.noise_hu, per_mm_of_contrast * levels.contrast_hu()});
  const auto steepness = steepness_of(scene.smoother);
  walls.ridge = find_ridges(scene.smoother, steepness, scene.room, edge);
  for (std::size_t v = 0; v < scene.hu.voxels.size(); ++v)
    if (scene.room.voxels[v] && static_cast<double>(steepness.voxels[v]) < flat_share * edge &&
        static_cast<double>(scene.smoother.voxels[v]) > levels.muscle_hu - below_muscle_hu)
      walls.flat.push_back(scene.smoother.voxels[v]);
  return walls;
}

}  // namespace heartgen::naming
