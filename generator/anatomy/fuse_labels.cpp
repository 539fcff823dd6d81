// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/fuse_labels.hpp"

#include <algorithm>
#include <vector>

#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/morphology.hpp"
#include "model/crop.hpp"
#include "model/labels.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double island_share = 0.01;  // of its region: pieces smaller than this are islands
constexpr std::uint8_t last_heart_tag = tag(Region::pulmonary_artery);

void put(LabelVolume& labels, const Mask& mask, Region region) {
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v]) labels.voxels[v] = tag(region);
}

void put_labels(LabelVolume& labels, const LabelVolume& part) {
  for (std::size_t v = 0; v < part.voxels.size(); ++v)
    if (part.voxels[v]) labels.voxels[v] = part.voxels[v];
}

/// Marks the voxels of pieces with fewer than island_share of their region's voxels.
void mark_islands(const LabelVolume& labels, Region region, Mask& islands) {
  Mask mask(labels.grid);
  std::int64_t total = 0;
  for (std::size_t v = 0; v < mask.voxels.size(); ++v) {
    mask.voxels[v] = labels.voxels[v] == tag(region);
    total += mask.voxels[v];
  }
  if (total == 0) return;
  const image::Components pieces = image::connected_components(mask);
  const auto least = static_cast<std::int64_t>(island_share * static_cast<double>(total));
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v] && pieces.voxel_count[static_cast<std::size_t>(pieces.label.voxels[v])] < least)
      islands.voxels[v] = 1;
}

/// Islands take the nearest label for which `takes` is true, not an island's own, at most `reach_mm` away.
template <class Takes>
void absorb(LabelVolume& labels, Mask& islands, double reach_mm, Takes takes) {
  LabelVolume rest(labels.grid);
  for (std::size_t v = 0; v < rest.voxels.size(); ++v)
    if (!islands.voxels[v] && takes(labels.voxels[v])) rest.voxels[v] = labels.voxels[v];
  const LabelVolume nearest = image::nearest_label(rest, reach_mm);
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    if (!islands.voxels[v] || nearest.voxels[v] == 0) continue;
    labels.voxels[v] = nearest.voxels[v];
    islands.voxels[v] = 0;
  }
}

/// The islands with a voxel that shares a corner with a chamber's blood.
Mask beside_blood(const LabelVolume& labels, const Mask& islands) {
  Mask blood(labels.grid);
  for (std::size_t v = 0; v < blood.voxels.size(); ++v)
    blood.voxels[v] = labels.voxels[v] >= tag(Region::lv_blood) && labels.voxels[v] <= tag(Region::ra_blood);
  const Mask near = image::dilate(blood, 1.01 * norm(labels.grid.spacing_mm));
  const image::Components pieces = image::connected_components(islands);
  std::vector<std::uint8_t> touches(pieces.voxel_count.size(), 0);
  for (std::size_t v = 0; v < islands.voxels.size(); ++v)
    if (near.voxels[v]) touches[static_cast<std::size_t>(pieces.label.voxels[v])] = 1;
  Mask result(labels.grid);
  for (std::size_t v = 0; v < islands.voxels.size(); ++v)
    result.voxels[v] = islands.voxels[v] && touches[static_cast<std::size_t>(pieces.label.voxels[v])];
  return result;
}

/// A piece of wall next to another wall or beside blood becomes part of a wall, so that none opens; other islands take
/// what is nearest.
void absorb_islands(LabelVolume& all) {
  constexpr std::int64_t margin = 3;  // voxels: an island's neighbours
  const Box box = bounding_box(all, margin, [](std::uint8_t label) { return label != 0 && label <= last_heart_tag; });
  if (box.empty()) return;
  LabelVolume labels = crop(all, box);
  const auto is_wall = [](std::uint8_t label) { return is_myocardium(static_cast<Region>(label)); };
  Mask wall_islands(labels.grid);
  Mask islands(labels.grid);
  for (std::uint8_t label = 1; label <= last_heart_tag; ++label)
    if (label != tag(Region::papillary))
      mark_islands(labels, static_cast<Region>(label), is_wall(label) ? wall_islands : islands);
  const Vec3& spacing = all.grid.spacing_mm;
  absorb(labels, wall_islands, 1.01 * std::max({spacing.x, spacing.y, spacing.z}), is_wall);
  Mask covers = beside_blood(labels, wall_islands);
  wall_islands = image::subtract(wall_islands, covers);
  absorb(labels, covers, 1e3, is_wall);
  for (std::size_t v = 0; v < islands.voxels.size(); ++v) islands.voxels[v] |= wall_islands.voxels[v];
  absorb(labels, islands, 1e3, [](std::uint8_t) { return true; });
  paste(labels, box, all);
}

}  // namespace

LabelVolume label_surroundings(const BodyResult& body, const Mask& trachea) {
  LabelVolume labels(body.body.grid);
  put(labels, body.body, Region::torso);
  put(labels, body.liver, Region::liver);
  put(labels, body.lung, Region::lung);
  put(labels, body.bone, Region::bone);
  put(labels, trachea, Region::trachea);
  return labels;
}

LabelVolume fuse_labels(const LabelVolume& chambers, const LabelVolume& walls, const LabelVolume& surroundings) {
  LabelVolume labels = surroundings;
  put_labels(labels, walls);
  put_labels(labels, chambers);
  absorb_islands(labels);
  return labels;
}

}  // namespace heartgen::anatomy
