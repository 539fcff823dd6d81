// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the pulmonary valve, which no constriction marks.
#pragma once
#include "generator/landmarks/faint_right_heart.hpp"
#include "generator/landmarks/valve_patch.hpp"

namespace heartgen::landmarks {

/// Walks from the pulmonary artery upstream into the ventricle's outflow tract and puts the valve where the fat
/// around the artery gives way to the muscle around the outflow tract. Where the right heart is `faint`, and its blood
/// no sure inner surface of a wall, the valve is where the tissue next to the fat darkens from muscle to the artery's
/// thin wall. `start` is where the two pools were parted. Where no wall tells, it is the end of the walk or `start`,
/// whichever is nearer to `typical_mm`, the place where it usually lies.
ValvePatch find_pulmonary_valve(const LabelVolume& chambers, const chest::WorkingImage& image,
                                const std::optional<FaintRightHeart>& faint, const ValvePatch& start,
                                const std::optional<Vec3>& typical_mm);

}  // namespace heartgen::landmarks
