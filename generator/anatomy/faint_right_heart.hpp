// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The right heart's blood at full resolution where it is hardly brighter, or darker, than muscle (see
/// faint_blood.hpp).
#pragma once
#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// With less contrast between the right heart's blood and muscle than this, grey values are summed up over places, and
/// what is known of the heart's shape counts as well; more of it shows the blood by itself, and so does more than this
/// share of the left heart's contrast: that must be much the brighter one.
constexpr double faint_contrast_hu = 130, faint_contrast_share = 0.5;

struct RightHeartBlood {
  Mask blood;    ///< the cavities with what stands in them
  Mask muscles;  ///< the part of `blood` that is papillary muscles and bands of the right ventricle. A seed may lie in
                 ///< one and a pocket behind one: the cavities are to be told apart first
};

/// Blood of right ventricle, right atrium and pulmonary artery on the grid of `ct`, the heart's part of the image.
/// `muscle_hu` and `left_hu` are the grey values of muscle and of the left heart's blood, which must be the brightest.
/// Needs the seeds lv_blood, la_blood, rv_blood and ra_blood; aorta, pulmonary_artery and the valves help. Worked out
/// on a grid of 1 mm. Throws UserError for a seed of the right heart that is not in soft tissue inside the heart.
RightHeartBlood faint_right_heart(const CtVolume& ct, const Landmarks& landmarks, double muscle_hu, double left_hu);

}  // namespace heartgen::anatomy
