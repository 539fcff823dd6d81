// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/vessel_ends.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "generator/image/box_around.hpp"
#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/flood.hpp"
#include "generator/image/morphology.hpp"
#include "generator/image/sections.hpp"
#include "model/mathematics.hpp"
#include "model/priors.hpp"
#include "model/quantile.hpp"

namespace heartgen::anatomy {
namespace {

constexpr double slice_mm = 4;  // thickness of the slices of a vessel whose centroids give its axis
constexpr double lever_mm = 8;  // distance between them

Vec3 position(const Grid& grid, std::size_t v) {
  const auto offset = static_cast<std::int64_t>(v);
  const auto row = offset / grid.size[0], slice = row / grid.size[1];
  return lps_from_index(grid, {static_cast<double>(offset % grid.size[0]), static_cast<double>(row % grid.size[1]),
                               static_cast<double>(slice)});
}

Volume<float> mask_as_float(const Mask& mask) {
  Volume<float> result(mask.grid);
  std::copy(mask.voxels.begin(), mask.voxels.end(), result.voxels.begin());
  return result;
}

Mask shell(const Volume<float>& way_mm, double from_mm, double to_mm) {
  Mask result(way_mm.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v) {
    const auto way = static_cast<double>(way_mm.voxels[v]);
    result.voxels[v] = way >= from_mm && way < to_mm;
  }
  return result;
}

struct Piece {
  Vec3 centroid;
  double volume_mm3 = 0;
};

/// The pieces of a mask of at least that volume.
std::vector<Piece> pieces_of(const Mask& mask, double min_mm3) {
  const image::Components components = image::connected_components(mask);
  std::vector<Piece> pieces(components.voxel_count.size());
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (const auto label = components.label.voxels[v]; label > 0)
      pieces[static_cast<std::size_t>(label)].centroid += position(mask.grid, v);
  for (std::size_t n = 1; n < pieces.size(); ++n) {
    const auto voxels = static_cast<double>(components.voxel_count[n]);
    pieces[n] = {pieces[n].centroid / voxels, voxels * mask.grid.voxel_volume_mm3()};
  }
  pieces.erase(pieces.begin());
  std::erase_if(pieces, [&](const Piece& piece) { return piece.volume_mm3 < min_mm3; });
  return pieces;
}

const Piece& nearest(const std::vector<Piece>& pieces, const Vec3& to) {
  return *std::min_element(pieces.begin(), pieces.end(), [&](const Piece& a, const Piece& b) {
    return norm(a.centroid - to) < norm(b.centroid - to);
  });
}

/// The opening of a chamber by a share of its inscribed radius, the piece that holds the deepest point.
Mask wide_part(const Mask& whole, double core_share) {
  const Box box = bounding_box(whole, 1, [](std::uint8_t on) { return on != 0; });
  if (box.empty()) return whole;
  const Mask chamber = crop(whole, box);
  Mask outside(chamber.grid);
  for (std::size_t v = 0; v < outside.voxels.size(); ++v) outside.voxels[v] = chamber.voxels[v] == 0;
  const auto depth = image::distance_to(outside, 1e3F);
  const auto deepest = std::max_element(depth.voxels.begin(), depth.voxels.end());
  const double radius = core_share * static_cast<double>(*deepest);
  const auto at = deepest - depth.voxels.begin();
  const Index3 seed{at % chamber.grid.size[0], at / chamber.grid.size[0] % chamber.grid.size[1],
                    at / (chamber.grid.size[0] * chamber.grid.size[1])};
  return image::pasted(whole.grid, image::component_of(image::intersect(image::open(chamber, radius), chamber), seed),
                       box);
}

/// A plane perpendicular to a vessel, and the direction in which it leaves.
struct End {
  Vec3 at, axis;
};

/// The piece of `whole` that holds the first voxel of `part` in it.
Mask piece_with(const Mask& whole, const Mask& part) {
  const auto in_both = [&](std::size_t v) { return whole.voxels[v] && part.voxels[v]; };
  std::size_t v = 0;
  while (v < whole.voxels.size() && !in_both(v)) ++v;
  if (v == whole.voxels.size()) return whole;
  const auto [nx, ny, nz] = whole.grid.size;
  const auto at = static_cast<std::int64_t>(v);
  return image::component_of(whole, {at % nx, at / nx % ny, at / (nx * ny)});
}

/// What lies at heights within 2 mm of `z_mm` and is no thin vessel.
std::vector<Piece> pieces_at(const Mask& region, double z_mm) {
  Mask slab = region;
  for (std::size_t v = 0; v < slab.voxels.size(); ++v)
    if (std::abs(position(region.grid, v).z - z_mm) > slice_mm / 2) slab.voxels[v] = 0;
  return pieces_of(slab, priors::vein_section_min_mm2 * slice_mm);
}

/// Where the atrium's wide part lies.
struct Core {
  double lowest_mm = 0, highest_mm = 0;
  Vec3 middle_mm;
  double reach_mm = 0;  ///< level, from the middle
};

double level_distance(const Vec3& a, const Vec3& b) { return math::hypot(a.x - b.x, a.y - b.y); }

Core measure_core(const Mask& core) {
  Core result{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), {}, 0};
  const auto for_each = [&](const auto& visit) {
    for (std::size_t v = 0; v < core.voxels.size(); ++v)
      if (core.voxels[v]) visit(position(core.grid, v));
  };
  for_each([&](const Vec3& at) {
    result.lowest_mm = std::min(result.lowest_mm, at.z);
    result.highest_mm = std::max(result.highest_mm, at.z);
    result.middle_mm += at;
  });
  result.middle_mm = result.middle_mm / std::max(static_cast<double>(image::count(core)), 1.0);
  for_each([&](const Vec3& at) { result.reach_mm = std::max(result.reach_mm, level_distance(at, result.middle_mm)); });
  return result;
}

/// Where a vena cava that leaves upwards (`way` 1) or downwards (-1) crosses the height `z_mm`, and its axis away from
/// the atrium. Nothing where it cannot be followed far enough, or widens or turns away beyond, or is not above or below
/// the atrium: other tissue that was taken for blood, as far as the spine.
std::optional<End> cava_at(const Mask& atrium, const Core& core, double z_mm, double way) {
  const auto here = pieces_at(atrium, z_mm), beyond = pieces_at(atrium, z_mm + way * lever_mm);
  if (here.empty() || beyond.empty()) return std::nullopt;
  const Piece& first = nearest(here, core.middle_mm);
  const Piece& second = nearest(beyond, first.centroid);
  if (level_distance(first.centroid, core.middle_mm) > core.reach_mm + priors::cava_beside_atrium_mm)
    return std::nullopt;
  if (second.volume_mm3 > priors::vein_max_widening * first.volume_mm3) return std::nullopt;
  const Vec3 axis = normalized(second.centroid - first.centroid);
  return way * axis.z > priors::vein_min_upright ? std::optional(End{first.centroid, axis}) : std::nullopt;
}

/// A vena cava's end, and its radius.
struct CavaEnd {
  End end;
  double radius_mm = 0;
};

/// The end `stump_radii` of the vein's radii away from where, followed inwards, its section has grown twice as large.
/// That tells the atrium's opening however the heart lies in the chest. The vein's own section is a median: farther out
/// contrast may fade, and one plane may be noise. Nothing where it does not grow so far.
std::optional<CavaEnd> cava_end(const Volume<float>& blood, const End& vein, double stump_radii) {
  constexpr int search_from_mm = 4, search_to_mm = -40, own_planes = 7;
  constexpr double search_mm = 6, opened = 2;
  std::vector<double> areas;  // at search_from_mm and every millimetre inwards
  for (int along_mm = search_from_mm; along_mm >= search_to_mm; --along_mm) {
    const auto found = image::section_at(blood, vein.at + along_mm * vein.axis, vein.axis, search_mm);
    areas.push_back(found ? found->area_mm2 : 0);
  }
  std::vector<double> own(areas.begin(), areas.begin() + own_planes);
  const double own_mm2 = upper_median(own), radius_mm = std::sqrt(own_mm2 / std::numbers::pi);
  if (own_mm2 == 0) return std::nullopt;
  for (std::size_t n = own_planes; n < areas.size(); ++n) {
    if (areas[n] <= opened * own_mm2) continue;
    const double t = std::clamp((areas[n] - opened * own_mm2) / (areas[n] - areas[n - 1]), 0.0, 1.0);
    const double end_mm = search_from_mm - static_cast<double>(n) + t + stump_radii * radius_mm;
    return CavaEnd{{vein.at + end_mm * vein.axis, vein.axis}, radius_mm};
  }
  return std::nullopt;
}

/// Takes from `atrium` a slice of a vein beyond its end, as long and as wide as no other part is near: what lies
/// farther out is no longer connected.
void cut_across(const CavaEnd& cava, Mask& atrium) {
  constexpr double wide_radii = 1.7, long_radii = 2;  // veins are flat, appendages near
  for (std::size_t v = 0; v < atrium.voxels.size(); ++v) {
    const Vec3 off = position(atrium.grid, v) - cava.end.at;
    const double along = dot(off, cava.end.axis);
    if (along > 0 && along < long_radii * cava.radius_mm &&
        norm(off - along * cava.end.axis) < wide_radii * cava.radius_mm)
      atrium.voxels[v] = 0;
  }
}

void cut_level(double height_mm, double way, Mask& atrium) {
  for (std::size_t v = 0; v < atrium.voxels.size(); ++v)
    if (way * (position(atrium.grid, v).z - height_mm) > 0) atrium.voxels[v] = 0;
}

}  // namespace

Mask cut_artery(const Mask& artery, const Mask& start, double length_mm) {
  const auto way = image::geodesic_distance(artery, start, length_mm + lever_mm);
  const auto ends =
      pieces_of(shell(way, length_mm - slice_mm / 2, length_mm + slice_mm / 2), priors::artery_piece_min_mm3);
  const auto before =
      pieces_of(shell(way, length_mm - slice_mm / 2 - lever_mm, length_mm + slice_mm / 2 - lever_mm), 0);
  Mask result(artery.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v) {
    const auto length = static_cast<double>(way.voxels[v]);
    if (length > length_mm + lever_mm) continue;
    if (ends.empty() || before.empty() || length < length_mm - lever_mm) {
      result.voxels[v] = length <= length_mm;
      continue;
    }
    const Vec3 at = position(artery.grid, v);
    const Vec3& end = nearest(ends, at).centroid;
    const Vec3 axis = normalized(end - nearest(before, end).centroid);
    result.voxels[v] = dot(at - end, axis) <= 0;
  }
  return image::largest_component(result);
}

Mask cut_veins(const Mask& chamber, double core_share, double stump_mm) {
  const auto way = image::geodesic_distance(chamber, wide_part(chamber, core_share), stump_mm);
  Mask result(chamber.grid);
  for (std::size_t v = 0; v < result.voxels.size(); ++v)
    result.voxels[v] = static_cast<double>(way.voxels[v]) <= stump_mm;
  return result;
}

Mask cut_venae_cavae(const Mask& atrium, double core_share, double stump_radii) {
  const Mask wide = wide_part(atrium, core_share);
  if (image::count(wide) == 0) return atrium;
  const Core core = measure_core(wide);
  const Volume<float> blood = mask_as_float(atrium);
  Mask result = atrium;
  for (const auto& [height_mm, way] : {std::pair{core.lowest_mm - priors::cava_below_atrium_mm, -1.0},
                                       std::pair{core.highest_mm + priors::cava_above_atrium_mm, 1.0}}) {
    const auto vein = cava_at(atrium, core, height_mm, way);
    if (const auto cava = vein ? cava_end(blood, *vein, stump_radii) : std::nullopt)
      cut_across(*cava, result);
    else
      cut_level(height_mm, way, result);
  }
  return piece_with(result, wide);
}

Mask drop_thin_branches(const Mask& region, double radius_mm) {
  constexpr double margin_mm = 1;
  const Mask wide = image::dilate(image::erode(region, radius_mm), radius_mm + margin_mm);
  return image::largest_component(image::intersect(wide, region));
}

}  // namespace heartgen::anatomy
