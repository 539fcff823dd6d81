// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Contrast-filled blood with a threshold that follows the local contrast. One global threshold fails where the right
/// heart is less enhanced than the left one, where contrast has not mixed with unenhanced blood, or where it is so
/// dense that it makes streaks: every place is cut half-way between muscle and the blood next to it instead.
#pragma once
#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

struct BloodPool {
  Mask blood;
  Volume<float> smooth;  ///< the image smoothed by 1.5 mm
  double muscle_hu = 0;  ///< median grey value of the shell of muscle around the left ventricle
  double blood_hu = 0;   ///< grey value of the left heart's blood
  Mask muscles{};  ///< part of `blood` where it is faint: muscles in the right ventricle (see faint_right_heart.hpp)
};

/// `ct` is the heart's part of the image. `soft_hu` is a first guess of the muscle's grey value. Uses the seeds
/// lv_blood, la_blood, rv_blood and ra_blood (all present); throws UserError for a seed that is not clearly brighter
/// than muscle.
BloodPool find_blood(const CtVolume& ct, const Landmarks& landmarks, double soft_hu);

}  // namespace heartgen::anatomy
