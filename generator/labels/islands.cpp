// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/labels/islands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/masks.hpp"
#include "model/crop.hpp"
#include "model/priors.hpp"

namespace heartgen::labels {
namespace {

constexpr std::size_t region_count = 18;

bool is_of_heart(std::uint8_t label) {
  const auto region = static_cast<Region>(label);
  return is_myocardium(region) || is_blood(region);
}

bool is_vessel(std::uint8_t label) { return label == tag(Region::aorta) || label == tag(Region::pulmonary_artery); }

/// The pieces of one region.
struct Pieces {
  std::uint8_t label = 0;
  image::Components parts;
  std::int32_t largest = 0;
};

std::vector<Pieces> pieces_of_regions(const LabelVolume& labels) {
  std::vector<Pieces> all;
  for (std::uint8_t label = 1; label < region_count; ++label) {
    if (!is_of_heart(label)) continue;
    Pieces pieces{
        label, image::connected_components(image::mask_where(labels, [&](std::uint8_t l) { return l == label; })), 0};
    const auto& counts = pieces.parts.voxel_count;
    if (counts.size() < 2) continue;
    pieces.largest = static_cast<std::int32_t>(std::max_element(counts.begin() + 1, counts.end()) - counts.begin());
    all.push_back(std::move(pieces));
  }
  return all;
}

/// The heart: what hangs together with the largest piece of a region.
Mask main_parts(const LabelVolume& labels, const std::vector<Pieces>& regions) {
  const auto whole = image::connected_components(image::mask_where(labels, is_of_heart));
  std::vector<std::uint8_t> stays(whole.voxel_count.size(), 0);
  for (const auto& pieces : regions)
    for (std::size_t v = 0; v < labels.voxels.size(); ++v)
      if (pieces.parts.label.voxels[v] == pieces.largest) {
        stays[static_cast<std::size_t>(whole.label.voxels[v])] = 1;
        break;
      }
  Mask main(labels.grid);
  for (std::size_t v = 0; v < labels.voxels.size(); ++v)
    main.voxels[v] = stays[static_cast<std::size_t>(whole.label.voxels[v])];
  return main;
}

struct Lost {
  std::int64_t voxels = 0;
  double nearest_mm = 1e9;
};

Warning warning_of(std::uint8_t label, const Lost& lost, double voxel_mm3) {
  return {"labels.islands", WarningLevel::warning,
          fmt::format("Of the given {}, {} voxels ({:.2g} ml) were dropped: islands {:.0f} mm from the heart.",
                      region_name(label), lost.voxels, static_cast<double>(lost.voxels) * voxel_mm3 / 1000,
                      lost.nearest_mm)};
}

/// The label, another one than their own, that each piece shares most area with.
std::vector<std::uint8_t> max_touched(const LabelVolume& labels, const Pieces& pieces) {
  const auto& size = labels.grid.size;
  const Vec3& s = labels.grid.spacing_mm;
  const std::array<double, 3> area{s.y * s.z, s.x * s.z, s.x * s.y};
  std::vector<std::array<double, region_count>> touched(pieces.parts.voxel_count.size());
  const auto add = [&](std::int64_t v, std::int64_t other, double mm2) {
    const auto piece = static_cast<std::size_t>(pieces.parts.label.voxels[static_cast<std::size_t>(v)]);
    const auto label = labels.voxels[static_cast<std::size_t>(other)];
    if (piece > 0 && label != pieces.label && label < region_count) touched[piece][label] += mm2;
  };
  const std::array<std::int64_t, 3> step{1, size[0], size[0] * size[1]};
  std::int64_t v = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v) {
        const std::array<bool, 3> has_next{i + 1 < size[0], j + 1 < size[1], k + 1 < size[2]};
        for (std::size_t axis = 0; axis < 3; ++axis)
          if (has_next[axis]) {
            add(v, v + step[axis], area[axis]);
            add(v + step[axis], v, area[axis]);
          }
      }
  std::vector<std::uint8_t> result;
  for (const auto& areas : touched)
    result.push_back(static_cast<std::uint8_t>(std::max_element(areas.begin(), areas.end()) - areas.begin()));
  return result;
}

double absorb_crumbs_of(LabelVolume& labels, const Pieces& pieces, double limit_mm3) {
  const double voxel_mm3 = labels.grid.voxel_volume_mm3();
  const auto is_crumb = [&](std::int32_t piece) {
    const auto voxels = static_cast<double>(pieces.parts.voxel_count[static_cast<std::size_t>(piece)]);
    const bool may_go = piece != pieces.largest || pieces.label == tag(Region::papillary);
    return piece > 0 && may_go && voxels * voxel_mm3 < limit_mm3;
  };
  bool any = false;
  for (std::int32_t piece = 1; piece < std::ssize(pieces.parts.voxel_count); ++piece) any |= is_crumb(piece);
  if (!any) return 0;
  const auto others = max_touched(labels, pieces);
  double changed = 0;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    const auto piece = pieces.parts.label.voxels[v];
    if (!is_crumb(piece)) continue;
    labels.voxels[v] = others[static_cast<std::size_t>(piece)];
    changed += voxel_mm3;
  }
  return changed;
}

}  // namespace

std::vector<Warning> drop_islands(LabelVolume& labels) {
  const Box box = bounding_box(labels, 1, is_of_heart);
  if (box.empty()) return {};
  LabelVolume part = crop(labels, box);
  const auto regions = pieces_of_regions(part);
  const Mask main = main_parts(part, regions);
  const double voxel_mm3 = part.grid.voxel_volume_mm3();
  Volume<float> distance;  // made when it is needed
  std::vector<Warning> warnings;
  for (const auto& pieces : regions) {
    Lost lost;
    for (std::size_t v = 0; v < part.voxels.size(); ++v) {
      const auto piece = static_cast<std::size_t>(pieces.parts.label.voxels[v]);
      if (piece == 0 || main.voxels[v]) continue;
      const bool is_large =
          static_cast<double>(pieces.parts.voxel_count[piece]) * voxel_mm3 >= priors::great_vessel_piece_min_mm3;
      if (is_vessel(pieces.label) && is_large) continue;
      if (distance.voxels.empty()) distance = image::distance_to(main);
      part.voxels[v] = 0;
      ++lost.voxels;
      lost.nearest_mm = std::min(lost.nearest_mm, static_cast<double>(distance.voxels[v]));
    }
    if (lost.voxels > 0) warnings.push_back(warning_of(pieces.label, lost, voxel_mm3));
  }
  if (!warnings.empty()) paste(part, box, labels);
  return warnings;
}

double absorb_crumbs(LabelVolume& labels, double limit_mm3) {
  const Box box = bounding_box(labels, 1, is_of_heart);
  if (box.empty()) return 0;
  LabelVolume part = crop(labels, box);
  double changed = 0;
  for (const auto& pieces : pieces_of_regions(part)) changed += absorb_crumbs_of(part, pieces, limit_mm3);
  if (changed > 0) paste(part, box, labels);
  return changed;
}

double crumb_mm3(double edge_mm) {
  constexpr double cells = 30, cell_per_cube = 0.1;  // of a tetrahedron, against the cube of its edge
  return cells * cell_per_cube * edge_mm * edge_mm * edge_mm;
}

}  // namespace heartgen::labels
