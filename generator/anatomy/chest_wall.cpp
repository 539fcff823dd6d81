// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/chest_wall.hpp"

#include <algorithm>
#include <vector>

#include "generator/image/components.hpp"
#include "generator/image/convex_slices.hpp"
#include "generator/image/distance.hpp"
#include "model/priors.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {

Mask lungs_of(const Volume<float>& smooth_hu) {
  Mask dark(smooth_hu.grid);
  std::transform(smooth_hu.voxels.begin(), smooth_hu.voxels.end(), dark.voxels.begin(),
                 [](float hu) { return static_cast<std::uint8_t>(hu < tissue::lung_max_hu); });
  const image::Components pieces = image::connected_components(dark);
  std::vector<std::int64_t> empty(pieces.voxel_count.size(), 0);
  for (std::size_t v = 0; v < dark.voxels.size(); ++v)
    if (smooth_hu.voxels[v] <= tissue::lung_min_hu) ++empty[static_cast<std::size_t>(pieces.label.voxels[v])];
  const auto least = static_cast<std::int64_t>(priors::lung_min_ml * 1000 / smooth_hu.grid.voxel_volume_mm3());
  for (std::size_t v = 0; v < dark.voxels.size(); ++v) {
    const auto label = static_cast<std::size_t>(pieces.label.voxels[v]);
    dark.voxels[v] = label > 0 && pieces.voxel_count[label] >= least && 2 * empty[label] < pieces.voxel_count[label];
  }
  return dark;
}

Mask beyond_the_lungs(const Mask& lung) {
  enum : std::uint8_t { outside = 0, lung_side = 1, heart_side = 2 };
  const Mask hull = image::convex_slices(lung, priors::lung_section_min_mm2);
  const Volume<float> to_lung = image::distance_to(lung);
  LabelVolume sides(lung.grid);
  for (std::size_t v = 0; v < sides.voxels.size(); ++v)
    if (hull.voxels[v]) sides.voxels[v] = to_lung.voxels[v] <= priors::pleura_mm ? lung_side : heart_side;
  const LabelVolume nearest = image::nearest_label(sides, priors::chest_wall_max_mm);
  Mask beyond(lung.grid);
  const auto slice = static_cast<std::size_t>(lung.grid.size[0] * lung.grid.size[1]);
  for (std::size_t first = 0; first < sides.voxels.size(); first += slice) {
    const auto begin = sides.voxels.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::all_of(begin, begin + static_cast<std::ptrdiff_t>(slice), [](auto side) { return side == outside; }))
      continue;
    for (std::size_t v = first; v < first + slice; ++v)
      beyond.voxels[v] = sides.voxels[v] == outside && nearest.voxels[v] == lung_side;
  }
  return beyond;
}

}  // namespace heartgen::anatomy
