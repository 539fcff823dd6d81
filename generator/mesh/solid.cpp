// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/pde/fast_sweeping.hpp"
#include "model/mathematics.hpp"

namespace heartgen::mesh {
namespace {

// Greater distances nobody asks for: nodes are looked for within an edge or two, rolling balls within their radius.
float band_of(double narrowest_mm) { return static_cast<float>(3 * std::max(1.0, narrowest_mm)); }

// The grid of the domain with each voxel divided into parts of about `voxel_mm`.
Grid finer_grid(const Grid& grid, double voxel_mm) {
  Grid finer = grid;
  Vec3 first;
  for (int axis = 0; axis < 3; ++axis) {
    const double parts = std::max(1.0, std::round(grid.spacing_mm[axis] / voxel_mm));
    first[axis] = 0.5 / parts - 0.5;
    finer.spacing_mm[axis] /= parts;
    finer.size[static_cast<std::size_t>(axis)] *= static_cast<std::int64_t>(parts);
  }
  finer.origin_mm = lps_from_index(grid, first);
  return finer;
}

/// Distances to the surfaces of the heart and of the blood of either side, each smooth by itself.
std::array<LevelSet, 3> heart_surfaces(const MeshDomain& domain, double voxel_mm, float band_mm) {
  const Grid grid = finer_grid(domain.grid, voxel_mm);
  std::array<LevelSet, 3> surfaces{LevelSet(grid), LevelSet(grid), LevelSet(grid)};
  const Vec3 origin = index_from_lps(domain.grid, grid.origin_mm);
  const Vec3 step{grid.spacing_mm.x / domain.grid.spacing_mm.x, grid.spacing_mm.y / domain.grid.spacing_mm.y,
                  grid.spacing_mm.z / domain.grid.spacing_mm.z};
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const Vec3 steps{static_cast<double>(i) * step.x, static_cast<double>(j) * step.y,
                           static_cast<double>(k) * step.z};
          const auto shares = heart_shares(domain, origin + steps);
          surfaces[0](i, j, k) = 0.5F - shares.heart;
          surfaces[1](i, j, k) = shares.left_blood - 0.5F;
          surfaces[2](i, j, k) = shares.right_blood - 0.5F;
        }
  });
  for (auto& surface : surfaces) surface = pde::fast_sweeping(surface, band_mm);
  return surfaces;
}

/// Takes away what a ball cannot reach from inside (`side` 1: opening) or fills what it cannot reach from outside (-1:
/// closing). Distances from voxel centres, with half a voxel to spare, only tell where the ball cannot go: elsewhere
/// surfaces stay.
void roll(LevelSet& distance, float radius_mm, float side, float band_mm) {
  const auto& spacing = distance.grid.spacing_mm;
  const auto half_voxel = static_cast<float>(0.5 * math::cbrt(spacing.x * spacing.y * spacing.z));
  Mask core(distance.grid);
  for (std::size_t v = 0; v < core.voxels.size(); ++v)
    core.voxels[v] = side * distance.voxels[v] <= half_voxel - radius_mm;
  const auto from_core = image::distance_to(core);
  for (std::size_t v = 0; v < core.voxels.size(); ++v) {
    const float reached = std::min(from_core.voxels[v] - radius_mm - half_voxel, band_mm);
    distance.voxels[v] = side * std::max(side * distance.voxels[v], reached);
  }
}

// Where a ball does not pass a bridge or fills one, it leaves islands and bubbles. They go, but for the largest: the
// inside's (`side` 1) become outside or the other way round (-1), as deep as they were.
void drop_islands(LevelSet& distance, double min_mm3, float side) {
  Mask inside(distance.grid);
  for (std::size_t v = 0; v < inside.voxels.size(); ++v) inside.voxels[v] = side * distance.voxels[v] < 0;
  const auto parts = image::connected_components(inside);
  const auto largest = std::max_element(parts.voxel_count.begin() + 1, parts.voxel_count.end());
  const auto least = std::min(static_cast<std::int64_t>(min_mm3 / distance.grid.voxel_volume_mm3()),
                              parts.voxel_count.size() > 1 ? *largest : 0);
  for (std::size_t v = 0; v < inside.voxels.size(); ++v)
    if (inside.voxels[v] != 0 && parts.voxel_count[static_cast<std::size_t>(parts.label.voxels[v])] < least)
      distance.voxels[v] = -distance.voxels[v];
}

}  // namespace

LevelSet wall_level_set(const MeshDomain& domain, double voxel_mm, const Narrowest& narrowest) {
  constexpr double blur_mm = 0.4;
  constexpr float after_blur = 0.7F;     // rods and tips are thinner then, and no face fits a needle; sheets are not
  constexpr double smallest_part = 100;  // cubes of the narrowest wall: a ball five or six of them wide
  const auto wall_radius = static_cast<float>(narrowest.wall_mm / 2);
  const auto gap_radius = static_cast<float>(narrowest.gap_mm / 2);
  const auto band = band_of(std::max(narrowest.wall_mm, narrowest.gap_mm));
  const auto surfaces = heart_surfaces(domain, voxel_mm, band);
  LevelSet level_set(surfaces[0].grid);
  for (std::size_t v = 0; v < level_set.voxels.size(); ++v)
    level_set.voxels[v] = std::max({surfaces[0].voxels[v], surfaces[1].voxels[v], surfaces[2].voxels[v]});
  roll(level_set, gap_radius, -1, band);
  roll(level_set, wall_radius, 1, band);
  const auto& spacing = level_set.grid.spacing_mm;
  smooth(level_set, gaussian_kernels({blur_mm / spacing.x, blur_mm / spacing.y, blur_mm / spacing.z}));
  roll(level_set, after_blur * wall_radius, 1, band);
  const double min_mm3 = smallest_part * math::pow(narrowest.wall_mm, 3);
  drop_islands(level_set, min_mm3, 1);
  drop_islands(level_set, min_mm3, -1);
  return level_set;
}

LevelSet smooth_distance(const Mask& mask, double smoothing_mm) {
  constexpr double min_smoothing_voxels = 1.3;  // less follows the stairs
  auto level_set = image::signed_distance(mask);
  Vec3 sigma;
  for (int axis = 0; axis < 3; ++axis)
    sigma[axis] = std::max(smoothing_mm / level_set.grid.spacing_mm[axis], min_smoothing_voxels);
  smooth(level_set, sharp_kernels(sigma));
  return level_set;
}

}  // namespace heartgen::mesh
