// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Four balls of blood, the left ventricle's in a wall: touches as in a heart, at 2 mm.
#pragma once
#include <algorithm>

#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::testing {

inline Region toy_region(const Vec3& p) {
  using enum Region;
  constexpr double radius = 20, wall = 28;
  const Vec3 lv{30, 0, -16}, rv{-14, 0, -16}, la{30, 0, 16}, ra{-14, 0, 16};
  if (norm(p - lv) < radius && p.z < 0) return lv_blood;
  if (norm(p - rv) < radius && p.z < 0) return rv_blood;
  if (norm(p - la) < radius && p.z >= 0) return la_blood;
  if (norm(p - ra) < radius && p.z >= 0) return ra_blood;
  return norm(p - lv) < wall && p.z < 0 ? lv_myocardium : none;
}

inline Vec3 place_of(const Grid& grid, std::int64_t i, std::int64_t j, std::int64_t k) {
  return lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
}

/// Sets `value(place)` everywhere.
template <class T, class Value>
void fill(Volume<T>& volume, Value value) {
  std::size_t v = 0;
  for (std::int64_t k = 0; k < volume.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < volume.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < volume.grid.size[0]; ++i, ++v)
        volume.voxels[v] = static_cast<T>(value(place_of(volume.grid, i, j, k), volume.voxels[v]));
}

/// 160 x 80 x 100 mm around the origin.
inline LabelVolume toy_heart() {
  Grid grid;
  grid.size = {80, 40, 50};
  grid.spacing_mm = {2, 2, 2};
  grid.origin_mm = {-79, -39, -49};
  LabelVolume labels(grid);
  fill(labels, [](const Vec3& p, std::uint8_t) { return tag(toy_region(p)); });
  return labels;
}

/// Blood of 350 HU in muscle of 110.
inline CtVolume toy_ct(const LabelVolume& labels) {
  CtVolume ct(labels.grid, 110);
  for (std::size_t v = 0; v < ct.voxels.size(); ++v)
    if (is_blood(static_cast<Region>(labels.voxels[v]))) ct.voxels[v] = 350;
  return ct;
}

inline std::int64_t voxels_of(const LabelVolume& labels, Region region) {
  return std::count(labels.voxels.begin(), labels.voxels.end(), tag(region));
}

}  // namespace heartgen::testing
