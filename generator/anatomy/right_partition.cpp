// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/right_partition.hpp"

#include <algorithm>
#include <cmath>

#include "generator/anatomy/wall_thickness.hpp"
#include "generator/image/gaussian.hpp"
#include "generator/image/morphology.hpp"
#include "generator/pde/fast_sweeping.hpp"
#include "model/labels.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double orifice_mm = 6;         // on both sides of the valve there is no wall inside its radius
constexpr double other_walls_mm = 1;     // end at least this far from grey values that speak for this wall;
constexpr double off_other_left_mm = 5;  // those beside left atrium and aorta are thick and blurred
constexpr double neighbours_mm = 5;      // on the wall, that speak together
constexpr float far_mm = 40;             // from where atrium and the rest are divided no distance is asked for

/// Signed distance from where atrium and the rest are divided, positive in the rest; the voxels' stairs smoothed.
Volume<float> from_division(const LabelVolume& nearest) {
  constexpr double smoothing_mm = 1;
  Volume<float> level(nearest.grid);
  for (std::size_t v = 0; v < level.voxels.size(); ++v)
    level.voxels[v] = nearest.voxels[v] == tag(Region::ra_blood) ? -0.5F : 0.5F;
  return pde::fast_sweeping(image::gaussian(level, smoothing_mm), far_mm);
}

/// Negative in the orifice.
Volume<float> outside_orifice(const Grid& grid, const ValvePlane& valve) {
  Volume<float> outside(grid);
  const Vec3 normal = normalized(valve.normal);
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Vec3 offset =
            lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}) -
            valve.center_mm;
        const double along = dot(offset, normal), radial = norm(offset - along * normal);
        outside.voxels[v] = static_cast<float>(std::max(radial - valve.radius_mm, std::abs(along) - orifice_mm));
      }
  return outside;
}

}  // namespace

Volume<float> outside_right_partition(const Volume<float>& hu, const WallDistances& walls, const LabelVolume& nearest,
                                      const Mask& compartment, const ValvePlane& tricuspid,
                                      const FaintContrast& contrast, double wall_mm) {
  const Volume<float> orifice = outside_orifice(hu.grid, tricuspid);
  Mask speaks = image::dilate(compartment, blood_reach_mm);
  for (std::size_t v = 0; v < speaks.voxels.size(); ++v)
    speaks.voxels[v] = speaks.voxels[v] && orifice.voxels[v] > 0 &&
                       static_cast<double>(walls.from_outside.voxels[v]) > blurred_mm + other_walls_mm &&
                       static_cast<double>(walls.from_other_left.voxels[v]) > off_other_left_mm &&
                       static_cast<double>(walls.from_lv.voxels[v]) > walls.lv_wall_mm + other_walls_mm;
  Volume<float> outside = from_division(nearest);
  const auto middle = local_middle(hu, outside, wall_mm, speaks, contrast, {.across_mm = neighbours_mm});
  for (std::size_t v = 0; v < outside.voxels.size(); ++v)
    outside.voxels[v] =
        std::max(std::abs(outside.voxels[v] - middle.voxels[v]) - static_cast<float>(wall_mm / 2), -orifice.voxels[v]);
  return outside;
}

}  // namespace heartgen::anatomy
