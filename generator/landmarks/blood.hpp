// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the contrast-filled blood of the heart, and where the heart is.
#pragma once
#include "generator/landmarks/contrast.hpp"

namespace heartgen::landmarks {

/// Blood by a threshold that follows the local contrast: `fraction` of the way from soft tissue to the brightest
/// blood within 6 mm. Thin walls survive, and chambers of 200 HU are found beside chambers of 400 HU.
Mask local_blood(const chest::WorkingImage& image, const Contrast& contrast, double fraction);

/// Where heart blood may be: the chest without spine and ribs.
Mask without_spine(const Mask& chest, const chest::Spine& spine);

/// Centre of the largest accumulation of deep blood in `region`. Throws UserError where there is none.
Vec3 heart_centre(const Mask& blood, const Mask& region);

/// Blood within the reach of a heart around its centre, small dark islands (papillary muscles, leaflets) filled.
Mask heart_blood(const Mask& blood, const Mask& region, const Vec3& centre);

/// Farthest a heart and the roots of its vessels reach from the centre of its blood.
constexpr double heart_reach_mm = 110;

}  // namespace heartgen::landmarks
