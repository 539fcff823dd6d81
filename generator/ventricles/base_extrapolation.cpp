// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/ventricles/base_extrapolation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "generator/image/isotropic_distance.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/resample.hpp"
#include "generator/parallel/threads.hpp"
#include "model/crop.hpp"
#include "model/mathematics.hpp"
#include "model/priors.hpp"

namespace heartgen::ventricles {
namespace {

constexpr double below_voxels = 0.9;  // the nearest voxel is never above a plane: half a diagonal is 0.87
constexpr double lever_mm = 5;        // slopes are taken over as much; shorter, and steps of voxels show in them
constexpr double margin_mm = 6;       // distances next to what is looked at must be right

/// Takes what lies above a plane from just below it, along the axis.
void continue_straight(Volume<std::uint8_t>& parts, const Plane& plane, const Vec3& axis) {
  const Volume<std::uint8_t> source = parts;
  const double below_mm = below_voxels * parts.grid.spacing_mm.x, rise = dot(axis, plane.normal);
  parallel::parallel_for(0, parts.grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t v = begin; v < end; ++v) {
      const Vec3 p = image::voxel_center(parts.grid, v);
      const double height = -depth_below_mm(plane, p);
      if (height <= 0) continue;
      const Vec3 index = index_from_lps(parts.grid, p + ((height + below_mm) / rise) * axis);
      const auto i = std::llround(index.x), j = std::llround(index.y), k = std::llround(index.z);
      parts.voxels[static_cast<std::size_t>(v)] = parts.grid.contains(i, j, k) ? source(i, j, k) : tag(Part::outside);
    }
  });
}

/// Parts near a plane: what a continuation above it is made from and what it changes.
Box around_plane(const Volume<std::uint8_t>& parts, const Plane& plane, double depth_mm) {
  Volume<std::uint8_t> near = parts;
  for (std::size_t v = 0; v < near.voxels.size(); ++v)
    if (depth_below_mm(plane, image::voxel_center(parts.grid, static_cast<std::int64_t>(v))) > depth_mm)
      near.voxels[v] = tag(Part::outside);
  return bounding_box(near, std::llround(margin_mm / parts.grid.spacing_mm.x),
                      [](auto v) { return !is(v, Part::outside); });
}

/// Where a point above the plane gets its distances from: two points below it on its line along the axis.
struct Below {
  Vec3 near_mm, deep_mm;
  double share = 0;  ///< of the change from the deep one to the near one that goes on up to the point
};

Below below(const Plane& plane, const Vec3& axis, const Vec3& point_mm, double near_mm) {
  const double height = -depth_below_mm(plane, point_mm), rise = dot(axis, plane.normal);
  const auto at = [&](double depth_mm) { return point_mm + ((height + depth_mm) / rise) * axis; };
  return {at(near_mm), at(near_mm + lever_mm),
          priors::wall_straightens_mm * (1 - math::exp(-height / priors::wall_straightens_mm)) / lever_mm};
}

/// Gives each voxel above the plane to the part whose distance, continued linearly from below, is the least.
void continue_sloped(Volume<std::uint8_t>& parts, const Plane& plane, const Vec3& axis) {
  constexpr double smoothing_voxels = 1;  // a slope taken from voxels' steps would be one of them
  const double near_mm = below_voxels * parts.grid.spacing_mm.x;
  const Box box = around_plane(parts, plane, near_mm + lever_mm);
  if (box.empty()) return;
  const auto source = crop(parts, box);
  auto result = source;
  Volume<float> least(source.grid);
  std::fill(least.voxels.begin(), least.voxels.end(), std::numeric_limits<float>::max());
  for (const Part part : {Part::outside, Part::lv_wall, Part::rv_wall, Part::lv_cavity, Part::rv_cavity, Part::other}) {
    const Mask mask = image::mask_where(source, [part](auto v) { return is(v, part); });
    if (std::find(mask.voxels.begin(), mask.voxels.end(), 1) == mask.voxels.end()) continue;
    const LevelSet distance = image::signed_distance(mask, smoothing_voxels);
    parallel::parallel_for(0, source.grid.voxel_count(), [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t v = begin; v < end; ++v) {
        const Vec3 p = image::voxel_center(source.grid, v);
        if (depth_below_mm(plane, p) >= 0) continue;
        const auto [near, deep, share] = below(plane, axis, p, near_mm);
        const auto at = [&](const Vec3& q) { return sample_linear(distance, index_from_lps(source.grid, q)); };
        const float continued = static_cast<float>(at(near) + share * (at(near) - at(deep)));
        const auto n = static_cast<std::size_t>(v);
        if (continued < least.voxels[n]) least.voxels[n] = continued, result.voxels[n] = tag(part);
      }
    });
  }
  paste(result, box, parts);
}

}  // namespace

void extrapolate_above_base(Volume<std::uint8_t>& parts, const Plane& plane, const Vec3& axis) {
  constexpr int passes = 2;  // distances next to the plane are those of what was made up above it
  continue_straight(parts, plane, axis);
  for (int pass = 0; pass < passes; ++pass) continue_sloped(parts, plane, axis);
}

}  // namespace heartgen::ventricles
