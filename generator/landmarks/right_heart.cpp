// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/right_heart.hpp"

#include <algorithm>

#include "generator/image/components.hpp"
#include "generator/image/flood.hpp"
#include "generator/image/masks.hpp"
#include "generator/image/morphology.hpp"
#include "generator/landmarks/valve_patch.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double streaks_hu = 60;         // noise gives 10 to 30, undiluted contrast 200 and more
constexpr double streak_mm = 4.5;         // half the width of the dark streaks that are closed
constexpr double wall_mm = 2.5;           // closing keeps this far from the other pools
constexpr float darkest_streak_hu = -10;  // fat is no streak
constexpr float deep_mm = 3;              // markers stay clear of the walls

/// Standard deviation of the grey value deep inside.
double unevenness_hu(const Mask& pool, const Volume<float>& smooth) {
  const auto depth = chest::depth_of(pool);
  double n = 0, sum = 0, squares = 0;
  for (std::size_t v = 0; v < pool.voxels.size(); ++v) {
    if (depth.voxels[v] <= deep_mm) continue;
    const double hu = static_cast<double>(smooth.voxels[v]);
    n += 1;
    sum += hu;
    squares += hu * hu;
  }
  return n > 0 ? std::sqrt(std::max(squares / n - sum / n * (sum / n), 0.0)) : 0;
}

Mask closed_right_heart(const LabelVolume& chambers, const Volume<float>& smooth) {
  const Mask right = image::mask_of(chambers, Region::rv_blood);
  const Mask others = chest::mask_where(chambers.grid, [&](const Vec3&, std::size_t v) {
    return chambers.voxels[v] != 0 && chambers.voxels[v] != tag(Region::rv_blood);
  });
  const Mask near_others = image::dilate(others, wall_mm);
  const Mask closed = image::close(right, streak_mm);
  return chest::mask_where(chambers.grid, [&](const Vec3&, std::size_t v) {
    return right.voxels[v] || (closed.voxels[v] && !near_others.voxels[v] && chambers.voxels[v] == 0 &&
                               smooth.voxels[v] > darkest_streak_hu);
  });
}

/// Coordinates in the left ventricle's frame that tell the right heart's parts apart.
struct Frame {
  Vec3 base, axis, middle, to_artery;

  double towards_apex(const Vec3& p) const { return dot(p - base, axis); }
  /// From the side of the right atrium (right, low) to that of the pulmonary artery (left, high).
  double towards_artery(const Vec3& p) const { return dot(p - middle, to_artery); }
};

Frame make_frame(const LabelVolume& chambers, const LongAxis& axis) {
  const auto aortic = find_valve_patch(chambers, Region::lv_blood, Region::aorta);
  const Vec3 left_and_up{1, 0, 1};
  const Vec3 across = left_and_up - dot(left_and_up, axis.direction) * axis.direction;
  return {axis.base_mm, axis.direction, aortic ? aortic->centre_mm : axis.base_mm, normalized(across)};
}

/// The chamber that a deep point of the right heart certainly belongs to; none where it may be either of two.
Region certain_chamber(const Frame& frame, const Vec3& p) {
  const double s = frame.towards_apex(p), w = frame.towards_artery(p);
  if (s < -16 && w > 2) return Region::pulmonary_artery;
  if (s < -8 && w < -10) return Region::ra_blood;
  if (s > 22 || (s > 12 && w > 4)) return Region::rv_blood;
  return Region::none;
}

/// Points that certainly belong to one chamber.
std::vector<image::Marker> certain_markers(const Volume<float>& depth, const Frame& frame) {
  std::vector<image::Marker> markers;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < depth.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < depth.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < depth.grid.size[0]; ++i, ++v) {
        if (depth.voxels[v] <= deep_mm) continue;
        const Region region = certain_chamber(frame, chest::position_mm(depth.grid, i, j, k));
        if (region != Region::none) markers.push_back({tag(region), {i, j, k}});
      }
  return markers;
}

/// A pulmonary artery that the field of view cuts near its valve, too near to be certain: what of the right heart's
/// left half reaches the top of the image.
void mark_cut_artery(const Volume<float>& depth, const Frame& frame, std::vector<image::Marker>& markers) {
  constexpr double min_towards_artery_mm = 2, max_towards_apex_mm = 12;
  const std::int64_t k = depth.grid.size[2] - 1;
  for (std::int64_t j = 0; j < depth.grid.size[1]; ++j)
    for (std::int64_t i = 0; i < depth.grid.size[0]; ++i) {
      const Vec3 p = chest::position_mm(depth.grid, i, j, k);
      if (depth(i, j, k) > deep_mm && frame.towards_artery(p) > min_towards_artery_mm &&
          frame.towards_apex(p) < max_towards_apex_mm)
        markers.push_back({tag(Region::pulmonary_artery), {i, j, k}});
    }
}

/// The component with most voxels beside the neighbour; where none touches it, the largest.
Mask piece_beside(const Mask& all, const Mask& neighbour) {
  const Mask beside = image::dilate(neighbour, all.grid.spacing_mm.x);
  const auto parts = image::connected_components(all);
  std::vector<std::int64_t> touching(parts.voxel_count.size(), 0);
  for (std::size_t v = 0; v < all.voxels.size(); ++v)
    if (all.voxels[v] && beside.voxels[v]) ++touching[static_cast<std::size_t>(parts.label.voxels[v])];
  const auto most = std::max_element(touching.begin(), touching.end());
  if (*most == 0) return image::largest_component(all);
  const auto chosen = static_cast<std::int32_t>(most - touching.begin());
  return chest::mask_where(all.grid, [&](const Vec3&, std::size_t v) { return parts.label.voxels[v] == chosen; });
}

}  // namespace

bool split_right_heart(LabelVolume& chambers, const Volume<float>& smooth, const LongAxis& axis) {
  Mask right = image::mask_of(chambers, Region::rv_blood);
  const bool streaks = unevenness_hu(right, smooth) > streaks_hu;
  if (streaks) right = closed_right_heart(chambers, smooth);  // else it would bridge the groove beside the valve
  const auto depth = chest::depth_of(right);
  const Frame frame = make_frame(chambers, axis);
  auto markers = certain_markers(depth, frame);
  mark_cut_artery(depth, frame, markers);
  const auto parts = image::flood_from_markers(right, depth, markers, image::ValveBarrier(right.grid));
  for (std::size_t n = 0; n < right.voxels.size(); ++n)
    if (right.voxels[n]) chambers.voxels[n] = parts.voxels[n];
  return streaks;
}

void keep_main_pieces(LabelVolume& chambers) {
  constexpr double min_aorta_ml = 5;
  const auto least = static_cast<std::int64_t>(1000 * min_aorta_ml / chambers.grid.voxel_volume_mm3());
  for (const Region region : {Region::lv_blood, Region::rv_blood, Region::la_blood, Region::ra_blood, Region::aorta,
                              Region::pulmonary_artery}) {
    const Mask all = image::mask_of(chambers, region);
    const Mask kept = region == Region::aorta ? image::drop_small_components(all, least)
                      : region == Region::pulmonary_artery
                          ? piece_beside(all, image::mask_of(chambers, Region::rv_blood))
                          : image::largest_component(all);
    for (std::size_t v = 0; v < all.voxels.size(); ++v)
      if (all.voxels[v] && !kept.voxels[v]) chambers.voxels[v] = 0;
  }
}

}  // namespace heartgen::landmarks
