// SPDX-License-Identifier: GPL-3.0-or-later
// The second half of given_labels.hpp: given labels on top of our own.
#include <algorithm>
#include <array>

#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/morphology.hpp"
#include "generator/labels/given_labels.hpp"
#include "model/crop.hpp"

namespace heartgen::labels {
namespace {

bool is_definite(std::uint8_t label) { return label != 0 && label != tag(Region::torso); }

template <class Rule>
Mask mask_of_regions(const LabelVolume& labels, Rule rule) {
  return image::mask_where(labels, [&](std::uint8_t label) { return rule(static_cast<Region>(label)); });
}

/// A chamber, its wall, and how thick that is at least.
struct Wall {
  Region blood, wall;
  double min_mm;
};

std::array<Wall, 4> walls_of(const EpicardiumSettings& settings) {
  using enum Region;
  return {{{lv_blood, lv_myocardium, settings.minimum_lv_wall_mm},
           {rv_blood, rv_myocardium, settings.minimum_rv_wall_mm},
           {la_blood, la_wall, settings.minimum_atrial_wall_mm},
           {ra_blood, ra_wall, settings.minimum_atrial_wall_mm}}};
}

/// Voxels next to the mask along an axis, whatever the slice thickness.
Mask touching(const Mask& mask) {
  Mask result(mask.grid);
  const auto [nx, ny, nz] = mask.grid.size;
  const std::array<std::int64_t, 3> step{1, nx, nx * ny};
  for (std::int64_t k = 0; k < nz; ++k)
    for (std::int64_t j = 0; j < ny; ++j)
      for (std::int64_t i = 0; i < nx; ++i) {
        const std::int64_t v = mask.grid.offset(i, j, k);
        if (!mask.voxels[static_cast<std::size_t>(v)]) continue;
        const std::array<std::int64_t, 3> at{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (at[axis] > 0) result.voxels[static_cast<std::size_t>(v - step[axis])] = 1;
          if (at[axis] + 1 < mask.grid.size[axis]) result.voxels[static_cast<std::size_t>(v + step[axis])] = 1;
        }
      }
  return result;
}

/// What a pocket next to that region is made of: papillary muscle where it is large enough for one.
Region filling(Region beside, bool is_large) {
  using enum Region;
  if (beside == la_wall || beside == ra_wall) return none;
  const bool ventricular = beside == lv_blood || beside == rv_blood || is_myocardium(beside);
  if (!ventricular) return beside;
  if (is_large) return papillary;
  return is_myocardium(beside) ? none : beside;
}

}  // namespace

LabelVolume only(const LabelVolume& labels, Group group) {
  LabelVolume result = labels;
  for (auto& label : result.voxels)
    if (label != 0 && group_of(static_cast<Region>(label)) != group) label = 0;
  return result;
}

LabelVolume with_given(LabelVolume own, const LabelVolume& given, Group group) {
  if (given.voxels.empty()) return own;
  std::array<bool, 256> is_given{};
  for (const auto label : given.voxels) is_given[label] = true;
  const std::uint8_t ground = group == Group::body ? tag(Region::torso) : 0;  // what a region of ours leaves behind
  for (std::size_t v = 0; v < own.voxels.size(); ++v) {
    auto& label = own.voxels[v];
    const std::uint8_t known = given.voxels[v];
    if (is_definite(label) && (is_given[label] || is_definite(known))) label = ground;
    if (known != 0 && group_of(static_cast<Region>(known)) == group) label = known;
  }
  return own;
}

LabelVolume with_all_given(LabelVolume own, const LabelVolume& given) {
  for (std::size_t v = 0; v < given.voxels.size(); ++v)
    if (is_definite(given.voxels[v])) own.voxels[v] = given.voxels[v];
  return own;
}

LabelVolume with_filled_pockets(LabelVolume chambers, const LabelVolume& given, double min_papillary_mm3) {
  const auto in_heart = [](std::uint8_t label) {
    return label != 0 && group_of(static_cast<Region>(label)) != Group::body;
  };
  const Box box = bounding_box(given, 1, in_heart);
  if (box.empty()) return chambers;
  LabelVolume heart = crop(given, box);
  for (auto& label : heart.voxels) label = in_heart(label) ? label : 0;
  const Mask solid = mask_of_regions(heart, [](Region r) { return r != Region::none; });
  const Mask pockets = image::subtract(image::fill_holes(solid), solid);
  if (image::count(pockets) == 0) return chambers;
  const LabelVolume nearest = image::nearest_label(heart, 1e9);
  const image::Components parts = image::connected_components(pockets);
  LabelVolume part = crop(chambers, box);
  for (std::size_t v = 0; v < pockets.voxels.size(); ++v) {
    if (!pockets.voxels[v] || part.voxels[v] != 0) continue;
    const auto voxels = parts.voxel_count[static_cast<std::size_t>(parts.label.voxels[v])];
    const bool is_large = static_cast<double>(voxels) * part.grid.voxel_volume_mm3() >= min_papillary_mm3;
    part.voxels[v] = tag(filling(static_cast<Region>(nearest.voxels[v]), is_large));
  }
  paste(part, box, chambers);
  return chambers;
}

LabelVolume near_heart(LabelVolume chambers, double reach_mm) {
  const auto is_vessel = [](Region r) { return r == Region::aorta || r == Region::pulmonary_artery; };
  const Box box = bounding_box(chambers, 0, [](std::uint8_t label) { return label != 0; });
  if (box.empty()) return chambers;
  LabelVolume part = crop(chambers, box);
  const auto distance =
      image::distance_to(mask_of_regions(part, [&](Region r) { return is_blood(r) && !is_vessel(r); }));
  for (std::size_t v = 0; v < part.voxels.size(); ++v)
    if (is_vessel(static_cast<Region>(part.voxels[v])) && static_cast<double>(distance.voxels[v]) > reach_mm)
      part.voxels[v] = 0;
  paste(part, box, chambers);
  return chambers;
}

LabelVolume min_walls(const LabelVolume& chambers, const LabelVolume& given, const EpicardiumSettings& settings) {
  const LabelVolume nearest = image::nearest_label(chambers, 1e9);
  LabelVolume walls(chambers.grid);
  for (const Wall& wall : walls_of(settings)) {
    if (holds(given, wall.wall)) continue;
    const Mask blood = mask_of_regions(chambers, [&](Region r) { return r == wall.blood; });
    const auto distance = image::distance_to(blood);
    const Mask contact = touching(blood);
    for (std::size_t v = 0; v < walls.voxels.size(); ++v) {
      const bool close = static_cast<double>(distance.voxels[v]) <= wall.min_mm || contact.voxels[v] != 0;
      if (close && chambers.voxels[v] == 0 && nearest.voxels[v] == tag(wall.blood)) walls.voxels[v] = tag(wall.wall);
    }
  }
  return with_given(std::move(walls), given, Group::walls);
}

}  // namespace heartgen::labels
