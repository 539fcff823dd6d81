// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The image all steps work on, and small helpers for grids whose axes are the patient's.
#pragma once
#include <cmath>
#include <vector>

#include "model/crop.hpp"
#include "model/volume.hpp"

namespace heartgen::chest {

/// Spacing of the working grid: fine enough for the atrial walls and valve planes (2 mm and more), coarse enough for
/// the whole search to take seconds.
constexpr double working_spacing_mm = 1.5;

/// Hounsfield units on a grid along the LPS axes with the same spacing in all directions; darker than fat,
/// but no air, outside the scan.
struct WorkingImage {
  Volume<float> hu;
  Volume<float> smooth;  ///< noise reduced by a Gaussian
};

/// Resamples to a grid of `spacing_mm`. Throws UserError for an image too thin to show a heart.
WorkingImage make_working_image(const CtVolume& ct, double spacing_mm = working_spacing_mm);

/// Every `step`-th voxel along each axis.
Volume<float> thinned(const Volume<float>& image, std::int64_t step);

inline WorkingImage crop(const WorkingImage& image, const Box& box) {
  return {crop(image.hu, box), crop(image.smooth, box)};
}

/// LPS position of a voxel of a grid along the LPS axes.
inline Vec3 position_mm(const Grid& grid, std::int64_t i, std::int64_t j, std::int64_t k) {
  return {grid.origin_mm.x + grid.spacing_mm.x * static_cast<double>(i),
          grid.origin_mm.y + grid.spacing_mm.y * static_cast<double>(j),
          grid.origin_mm.z + grid.spacing_mm.z * static_cast<double>(k)};
}

inline Index3 nearest_voxel(const Grid& grid, const Vec3& lps_mm) {
  const Vec3 at = index_from_lps(grid, lps_mm);
  return {std::llround(at.x), std::llround(at.y), std::llround(at.z)};
}

/// Calls visit(position, offset) for all voxels of a grid along the LPS axes, in memory order.
template <class Visit>
void for_each_voxel(const Grid& grid, Visit&& visit) {
  std::size_t offset = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++offset) visit(position_mm(grid, i, j, k), offset);
}

/// A mask by a rule on position and offset.
template <class Rule>
Mask mask_where(const Grid& grid, Rule&& rule) {
  Mask mask(grid);
  for_each_voxel(grid, [&](const Vec3& p, std::size_t v) { mask.voxels[v] = rule(p, v); });
  return mask;
}

inline Mask inverse(const Mask& mask) {
  Mask result(mask.grid);
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) result.voxels[v] = mask.voxels[v] == 0;
  return result;
}

/// Distance (mm) to the nearest unset voxel, 0 outside the mask.
Volume<float> depth_of(const Mask& mask);

}  // namespace heartgen::chest
