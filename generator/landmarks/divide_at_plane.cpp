// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/divide_at_plane.hpp"

#include <algorithm>

#include "generator/chest/working_image.hpp"
#include "generator/image/components.hpp"

namespace heartgen::landmarks {
namespace {

/// Gives the piece of `side` that holds most of a region to that region.
void claim_main_piece(LabelVolume& chambers, const Mask& side, Region region) {
  const auto pieces = image::connected_components(side);
  std::vector<std::int64_t> held(pieces.voxel_count.size(), 0);
  for (std::size_t v = 0; v < side.voxels.size(); ++v)
    if (side.voxels[v] && chambers.voxels[v] == tag(region)) ++held[static_cast<std::size_t>(pieces.label.voxels[v])];
  const auto main = std::max_element(held.begin(), held.end()) - held.begin();
  if (held[static_cast<std::size_t>(main)] == 0) return;
  for (std::size_t v = 0; v < side.voxels.size(); ++v)
    if (pieces.label.voxels[v] == main) chambers.voxels[v] = tag(region);
}

}  // namespace

void divide_at_plane(LabelVolume& chambers, Region ventricle, Region beyond, const Vec3& point, const Vec3& normal) {
  const auto on_side = [&](double sign) {
    return chest::mask_where(chambers.grid, [&](const Vec3& p, std::size_t v) {
      const bool blood = chambers.voxels[v] == tag(ventricle) || chambers.voxels[v] == tag(beyond);
      return blood && sign * dot(p - point, normal) > 0;
    });
  };
  const Mask above = on_side(1), below = on_side(-1);
  claim_main_piece(chambers, above, beyond);
  claim_main_piece(chambers, below, ventricle);
}

}  // namespace heartgen::landmarks
