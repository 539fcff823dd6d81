// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the right heart's first basin, and a chamber for every other basin.
#pragma once
#include "generator/landmarks/left_heart.hpp"

namespace heartgen::landmarks {

/// The basin that has most of its volume across the septum from the left ventricle; 0 where there is none.
std::int32_t find_right_heart(const image::Basins& basins, const Pools& pools, const LeftHeart& left);

/// Gives the chamber of the seed basins to the basins around them, widest way and most similar grey value first.
/// The whole right heart gets rv_blood. Basins that nothing wide enough leads to get nothing.
Assignment assign_basins(const image::Basins& basins, const Pools& pools, const LeftHeart& left, std::int32_t right);

/// The label map of an assignment.
LabelVolume label_map(const image::Basins& basins, const Assignment& assignment);

}  // namespace heartgen::landmarks
