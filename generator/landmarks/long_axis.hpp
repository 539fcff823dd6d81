// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the left ventricle's long axis and apex.
#pragma once
#include "generator/chest/working_image.hpp"

namespace heartgen::landmarks {

struct LongAxis {
  Vec3 base_mm;       ///< middle of the ventricle's outlet, between mitral and aortic valve
  Vec3 direction;     ///< unit, from base to apex
  Vec3 apex_mm;       ///< epicardial: where the axis leaves the muscle
  double spread_deg;  ///< between the axis from base to tip and the axis through the slices' centres
};

/// `chambers` holds lv_blood, la_blood and aorta; nothing else is used. The ventricle must not be empty.
LongAxis find_long_axis(const LabelVolume& chambers, const Volume<float>& smooth);

}  // namespace heartgen::landmarks
