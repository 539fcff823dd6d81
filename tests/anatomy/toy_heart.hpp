// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A heart of spheres and tubes with known labels: two ventricles with walls, two atria, an aorta, all in fat.
#pragma once
#include <cstdint>
#include <vector>

#include "generator/pde/hierarchy.hpp"
#include "model/labels.hpp"
#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

struct ToySettings {
  double left_hu = 400;
  double right_hu = 300;
  double noise_hu = 15;  ///< uniform noise of this standard deviation
};

struct ToyHeart {
  CtVolume ct;
  LabelVolume truth;  ///< the aorta runs to the border of the grid
  Landmarks landmarks;
  pde::SegmentationTree tree;  ///< grey values only
};

namespace toy {

inline bool in_ball(const Vec3& p, const Vec3& center, double radius) { return norm(p - center) < radius; }

/// A tube along axis `axis` from `from` on, `length` long.
inline bool in_tube(const Vec3& p, const Vec3& from, int axis, double length, double radius) {
  Vec3 offset = p - from;
  const double along = offset[axis];
  offset[axis] = 0;
  return along >= 0 && along < length && norm(offset) < radius;
}

inline const Vec3 lv{20, 0, -10}, rv{-22, 0, -10}, la{20, 0, 24}, ra{-22, 0, 22};

inline Region region_at(const Vec3& p) {
  if (in_ball(p, lv, 16) || in_tube(p, {20, 0, -10}, 2, 17.5, 9) || in_tube(p, lv, 1, 18, 6)) return Region::lv_blood;
  if (in_ball(p, rv, 15) || in_tube(p, {-22, 0, -10}, 2, 16.5, 9)) return Region::rv_blood;
  if (in_ball(p, la, 15) || in_tube(p, {20, 0, 7.5}, 2, 10, 9)) return Region::la_blood;
  if (in_ball(p, ra, 14) || in_tube(p, {-22, 0, 6.5}, 2, 10, 9)) return Region::ra_blood;
  if (in_tube(p, {20, 8, -10}, 1, 1000, 6)) return Region::aorta;
  if (p.z < 7 && in_ball(p, lv, 24)) return Region::lv_myocardium;
  if (p.z < 6 && in_ball(p, rv, 18.5)) return Region::rv_myocardium;
  if (in_ball(p, la, 17.5) || (p.z > 7 && in_tube(p, {20, 0, 7}, 2, 10, 11.5))) return Region::la_wall;
  if (in_ball(p, ra, 16.5) || (p.z > 6 && in_tube(p, {-22, 0, 6}, 2, 10, 11.5))) return Region::ra_wall;
  return Region::none;
}

inline double grey_at(Region region, const ToySettings& settings) {
  switch (region) {
    case Region::none:
      return -90;
    case Region::rv_blood:
    case Region::ra_blood:
      return settings.right_hu;
    case Region::lv_blood:
    case Region::la_blood:
    case Region::aorta:
      return settings.left_hu;
    default:
      return 110;
  }
}

}  // namespace toy

inline Landmarks toy_landmarks() {
  Landmarks landmarks;
  landmarks.seeds_mm = {{"lv_blood", toy::lv}, {"rv_blood", toy::rv}, {"la_blood", toy::la}, {"ra_blood", toy::ra}};
  landmarks.valves = {{"mitral", {{20, 0, 7.5}, {0, 0, 1}, 9}},
                      {"tricuspid", {{-22, 0, 6.5}, {0, 0, 1}, 9}},
                      {"aortic", {{20, 18, -10}, {0, 1, 0}, 6}}};
  return landmarks;
}

inline ToyHeart toy_heart(const ToySettings& settings = {}) {
  Grid grid;
  grid.size = {72, 72, 56};
  grid.spacing_mm = {1.5, 1.5, 1.8};
  grid.origin_mm = {-56, -36, -46};
  ToyHeart heart{CtVolume(grid), LabelVolume(grid), toy_landmarks(), {}};
  std::uint32_t state = 12345;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Region region = toy::region_at(
            lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
        state = state * 1664525U + 1013904223U;
        const double noise = (static_cast<double>(state >> 8U) / 16777216.0 - 0.5) * 3.46 * settings.noise_hu;
        heart.truth.voxels[v] = tag(region);
        heart.ct.voxels[v] = static_cast<std::int16_t>(toy::grey_at(region, settings) + noise);
      }
  heart.tree = {{"soft", {}, {}, -90, 110}, {"blood", {}, {}, 110, settings.left_hu}};
  return heart;
}

inline double dice(const LabelVolume& a, const LabelVolume& b, Region region) {
  std::int64_t both = 0, sum = 0;
  for (std::size_t v = 0; v < a.voxels.size(); ++v) {
    const bool in_a = a.voxels[v] == tag(region), in_b = b.voxels[v] == tag(region);
    both += in_a && in_b;
    sum += in_a + in_b;
  }
  return sum ? 2.0 * static_cast<double>(both) / static_cast<double>(sum) : 1;
}

}  // namespace heartgen::anatomy
