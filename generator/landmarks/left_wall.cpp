// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/landmarks/left_wall.hpp"

#include <vector>

#include "generator/chest/working_image.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/statistics.hpp"

namespace heartgen::landmarks {

LeftWall look_at_left_wall(const LabelVolume& chambers, const Volume<float>& smooth) {
  constexpr float from_mm = 3, to_mm = 7.5;
  constexpr float darkest_muscle_hu = 0, brightest_muscle_hu = 180, brighter_hu = 100;
  std::vector<float> blood;
  for (std::size_t v = 0; v < chambers.voxels.size(); ++v)
    if (chambers.voxels[v] == tag(Region::lv_blood)) blood.push_back(smooth.voxels[v]);
  const auto bone_hu = static_cast<float>(image::median(blood)) + brighter_hu;
  const auto distance = image::distance_to(chest::mask_where(
      chambers.grid, [&](const Vec3&, std::size_t v) { return chambers.voxels[v] == tag(Region::lv_blood); }));
  double all = 0, muscle = 0, bone = 0;
  for (std::size_t v = 0; v < distance.voxels.size(); ++v) {
    if (chambers.voxels[v] != 0 || distance.voxels[v] < from_mm || distance.voxels[v] > to_mm) continue;
    const float hu = smooth.voxels[v];
    ++all;
    muscle += hu > darkest_muscle_hu && hu < brightest_muscle_hu;
    bone += hu > bone_hu;
  }
  return all > 0 ? LeftWall{muscle / all, bone / all} : LeftWall{};
}

}  // namespace heartgen::landmarks
