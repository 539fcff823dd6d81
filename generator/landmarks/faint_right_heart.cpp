// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/faint_right_heart.hpp"

#include <algorithm>

#include "generator/image/basins.hpp"
#include "generator/image/components.hpp"
#include "generator/image/morphology.hpp"
#include "generator/image/statistics.hpp"
#include "model/labels.hpp"

namespace heartgen::landmarks {
namespace {

constexpr double reach_mm = 15;       // beyond the septum: where most of the right ventricle lies
constexpr double min_depth_mm = 6;    // of the right ventricle, its walls taken off
constexpr double largest_ml = 500;    // the liver is larger
constexpr double min_relative = 0.3;  // way between two parts of the right heart / the narrower of the two
constexpr double min_width_mm = 3;
constexpr double near_mm = 6;         // walls, and blood beyond what usual walls leave
constexpr double below_heart_mm = 5;  // the centre of no part of the heart lies lower than its lowest blood

/// What a basin is like.
struct Space {
  double volume_ml = 0, depth_mm = 0, across_septum_ml = 0;
  Vec3 centre_mm;
};

std::vector<Space> measure_spaces(const image::Basins& basins, const anatomy::WallDistances& walls) {
  std::vector<Space> spaces(static_cast<std::size_t>(basins.count) + 1);
  const double voxel_ml = basins.label.grid.voxel_volume_mm3() / 1000;
  chest::for_each_voxel(basins.label.grid, [&](const Vec3& p, std::size_t v) {
    Space& space = spaces[static_cast<std::size_t>(basins.label.voxels[v])];
    space.volume_ml += voxel_ml;
    space.centre_mm += voxel_ml * p;
    space.depth_mm = std::max(space.depth_mm, static_cast<double>(basins.depth_mm.voxels[v]));
    if (static_cast<double>(walls.from_lv.voxels[v]) < walls.lv_wall_mm + reach_mm) space.across_septum_ml += voxel_ml;
  });
  for (Space& space : spaces)
    if (space.volume_ml > 0) space.centre_mm = space.centre_mm / space.volume_ml;
  return spaces;
}

double lowest_z_mm(const LabelVolume& chambers) {
  double lowest = 1e9;
  chest::for_each_voxel(chambers.grid, [&](const Vec3& p, std::size_t v) {
    if (chambers.voxels[v] == tag(Region::lv_blood)) lowest = std::min(lowest, p.z);
  });
  return lowest;
}

bool may_be_heart(const Space& space, double lowest_mm) {
  return space.volume_ml < largest_ml && space.centre_mm.z > lowest_mm - below_heart_mm;
}

/// The space across the septum, and those that hang together with it.
std::vector<std::uint8_t> right_spaces(const image::Basins& basins, const std::vector<Space>& spaces,
                                       double lowest_mm) {
  std::vector<std::uint8_t> chosen(spaces.size(), 0);
  std::size_t start = 0;
  for (std::size_t n = 1; n < spaces.size(); ++n)
    if (may_be_heart(spaces[n], lowest_mm) && spaces[n].depth_mm > min_depth_mm &&
        spaces[n].across_septum_ml > spaces[start].across_septum_ml * (start != 0))
      start = n;
  if (start == 0) return {};
  chosen[start] = 1;
  for (bool grown = true; grown;) {
    grown = false;
    for (const auto& [pair, contact] : basins.contacts) {
      const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
      if (chosen[a] == chosen[b] || contact.width_mm < min_width_mm) continue;
      const double narrower = std::min(spaces[a].depth_mm, spaces[b].depth_mm);
      const std::size_t next = chosen[a] ? b : a;
      if (contact.width_mm < min_relative * narrower || !may_be_heart(spaces[next], lowest_mm)) continue;
      chosen[next] = 1;
      grown = true;
    }
  }
  return chosen;
}

}  // namespace

std::optional<FaintRightHeart> add_faint_right_heart(LabelVolume& chambers, const chest::WorkingImage& image,
                                                     const Mask& region, const LongAxis& axis, const Contrast& contrast,
                                                     double muscle_hu) {
  const Grid& grid = chambers.grid;
  const double left_hu = 0.5 * (contrast.soft_hu + contrast.blood_hu);
  const auto is = [&](std::size_t v, Region r) { return chambers.voxels[v] == tag(r); };
  const Mask lv = chest::mask_where(grid, [&](const Vec3&, std::size_t v) { return is(v, Region::lv_blood); });
  const Mask other = chest::mask_where(grid, [&](const Vec3&, std::size_t v) {
    return !lv.voxels[v] &&
           (is(v, Region::la_blood) || is(v, Region::aorta) || static_cast<double>(image.smooth.voxels[v]) > left_hu);
  });
  const Mask thin =
      chest::mask_where(grid, [&](const Vec3& p, std::size_t) { return dot(p - axis.base_mm, axis.direction) < 0; });
  const auto walls = anatomy::measure_walls(image.hu, lv, other, muscle_hu);
  const auto inside = anatomy::prior_cavity(walls, thin);
  const auto basins = image::divide_at_constrictions(
      chest::mask_where(grid, [&](const Vec3&, std::size_t v) { return region.voxels[v] && inside.voxels[v] > 0; }));
  const auto chosen = right_spaces(basins, measure_spaces(basins, walls), lowest_z_mm(chambers));
  if (chosen.empty()) return std::nullopt;
  const Mask compartment = chest::mask_where(
      grid, [&](const Vec3&, std::size_t v) { return chosen[static_cast<std::size_t>(basins.label.voxels[v])] != 0; });
  const auto grey = anatomy::measure_faint_contrast(image.hu, walls, inside, compartment);
  const auto blood = anatomy::faint_blood(image.hu, walls, inside, compartment, grey);
  const Mask right = image::largest_component(chest::mask_where(
      grid, [&](const Vec3&, std::size_t v) { return blood.voxels[v] > 0 && !lv.voxels[v] && !other.voxels[v]; }));
  for (std::size_t v = 0; v < right.voxels.size(); ++v) {
    if (is(v, Region::rv_blood)) chambers.voxels[v] = 0;
    if (right.voxels[v] && chambers.voxels[v] == 0) chambers.voxels[v] = tag(Region::rv_blood);
  }
  return FaintRightHeart{grey, walls, image::dilate(compartment, near_mm)};
}

}  // namespace heartgen::landmarks
