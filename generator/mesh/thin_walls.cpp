// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/thin_walls.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include "generator/image/distance.hpp"
#include "generator/parallel/threads.hpp"

namespace heartgen::mesh {
namespace {

Box box_of_muscle(const MeshDomain& domain) {
  Box box;
  const auto& size = domain.grid.size;
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++voxel)
        if (is_myocardium(static_cast<Region>(domain.voxels[voxel]))) box.add({i, j, k});
  return box;
}

/// Samples over the box and a voxel around it.
Grid sample_grid(const Grid& voxels, const Box& box, double sample_mm) {
  Grid grid = voxels;
  Vec3 first;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    first[axis] = static_cast<double>(box.low[a] - 1);
    const double length_mm = static_cast<double>(box.high[a] - box.low[a] + 2) * voxels.spacing_mm[axis];
    grid.size[a] = static_cast<std::int64_t>(std::ceil(length_mm / sample_mm)) + 1;
    grid.spacing_mm[axis] = sample_mm;
  }
  grid.origin_mm = lps_from_index(voxels, first);
  return grid;
}

LabelVolume regions_on(const MeshDomain& domain, const Grid& grid) {
  LabelVolume regions(grid);
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const Vec3 at{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          regions(i, j, k) = region_at(domain, index_from_lps(domain.grid, lps_from_index(grid, at)));
        }
  });
  return regions;
}

bool is_wall(Region region) { return is_myocardium(region) && region != Region::papillary; }

}  // namespace

Mask thin_walls(const MeshDomain& domain, double thickness_mm, double sample_mm) {
  const Box box = box_of_muscle(domain);
  if (box.empty()) {
    Grid none = domain.grid;
    none.size = {1, 1, 1};
    return Mask(none, 0);
  }
  const auto regions = regions_on(domain, sample_grid(domain.grid, box, sample_mm));
  Mask mask(regions.grid, 0);  // first all but muscle, then the centres of balls that fit, then what is thin
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    mask.voxels[v] = !is_myocardium(static_cast<Region>(regions.voxels[v]));
  const double radius = thickness_mm / 2;
  {
    const auto depth = image::distance_to(mask);
    // The surface lies half-way between samples on its two sides.
    for (std::size_t v = 0; v < mask.voxels.size(); ++v)
      mask.voxels[v] = static_cast<double>(depth.voxels[v]) >= radius + sample_mm / 2;
  }
  // The corner of a right-angled edge is sqrt(2) radii away from the ball in it.
  constexpr double beyond_corners = 1.5;
  const auto distance = image::distance_to(mask);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    mask.voxels[v] = is_wall(static_cast<Region>(regions.voxels[v])) &&
                     static_cast<double>(distance.voxels[v]) > beyond_corners * radius;
  return mask;
}

}  // namespace heartgen::mesh
