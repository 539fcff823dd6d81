// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: what is known about each basin of blood, and which chamber or vessel it belongs to.
#pragma once
#include <map>
#include <vector>

#include "generator/image/basins.hpp"
#include "generator/landmarks/contrast.hpp"
#include "model/labels.hpp"

namespace heartgen::landmarks {

struct Pool {
  double volume_ml = 0;
  Vec3 centre_mm;
  double top_mm = 0, bottom_mm = 0;  ///< highest and lowest z
  double depth_mm = 0;               ///< radius of the largest ball inside
  double hu = 0;                     ///< median
  double hu_deviation = 0;           ///< of its deep part: streaks are uneven
  double muscle_share = 0;           ///< of the shell 4 to 7.5 mm outside: the left ventricle's is muscle
  double fat_or_air_share = 0;       ///< of the same shell
  double shell_hu = 0;               ///< typical of its muscle
  double from_heart_mm = 0;          ///< distance of the centre from the heart's centre
  double left_mm = 0, front_mm = 0;  ///< of the spine
};

/// Basins of 1.5 ml and more by label.
using Pools = std::map<std::int32_t, Pool>;

Pools measure_pools(const chest::WorkingImage& image, const image::Basins& basins, const Contrast& contrast,
                    const chest::Spine& spine, const Vec3& heart_centre);

/// The chamber or vessel of each basin that has one.
using Assignment = std::map<std::int32_t, Region>;

/// Way from one pool to another relative to the narrower of the two, 0 to 1.
double relative_width(const image::Basins& basins, const Pools& pools, std::int32_t a, std::int32_t b);

}  // namespace heartgen::landmarks
