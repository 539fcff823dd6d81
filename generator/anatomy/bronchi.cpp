// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/bronchi.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "generator/image/components.hpp"
#include "generator/image/morphology.hpp"
#include "model/crop.hpp"
#include "model/priors.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double closing_mm = 1.5;  // gaps in a leak, whose voxels are dark by noise alone
constexpr double margin_mm = 8;

/// Voxels of the pieces of `mask` that hold a voxel of `start`.
Mask joined_to(const Mask& start, const Mask& mask) {
  const image::Components pieces = image::connected_components(image::unite(start, mask));
  std::vector<std::uint8_t> holds(pieces.voxel_count.size(), 0);
  for (std::size_t v = 0; v < start.voxels.size(); ++v)
    if (start.voxels[v]) holds[static_cast<std::size_t>(pieces.label.voxels[v])] = 1;
  Mask result(mask.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v)
    result.voxels[v] = holds[static_cast<std::size_t>(pieces.label.voxels[v])];
  return result;
}

bool leaks(const Mask& tree_all, const Mask& airways_all) {
  if (static_cast<double>(image::count(tree_all)) >
      (1 + priors::bronchi_max_share) * static_cast<double>(image::count(airways_all)))
    return true;
  const Vec3& spacing = tree_all.grid.spacing_mm;
  const auto margin = static_cast<std::int64_t>(std::ceil(margin_mm / std::min({spacing.x, spacing.y, spacing.z})));
  const Box box = bounding_box(tree_all, margin, [](std::uint8_t v) { return v != 0; });
  const Mask tree = crop(tree_all, box), airways = crop(airways_all, box);
  const Mask wide = image::erode(image::close(tree, closing_mm), priors::bronchus_max_radius_mm);
  return image::count(image::subtract(wide, image::dilate(airways, priors::airway_rim_mm))) > 0;
}

}  // namespace

Mask with_bronchi(const CtVolume& ct, const Mask& airways, const Mask& air, double lumen_hu, double lung_hu) {
  for (const double share : {0.65, 0.5, 0.35, 0.2}) {
    const double level = lumen_hu + share * (lung_hu - lumen_hu);
    Mask dark(ct.grid);
    for (std::size_t v = 0; v < dark.voxels.size(); ++v)
      dark.voxels[v] = air.voxels[v] && static_cast<double>(ct.voxels[v]) < level;
    Mask tree = joined_to(airways, dark);
    if (!leaks(tree, airways)) return tree;
  }
  return airways;
}

}  // namespace heartgen::anatomy
