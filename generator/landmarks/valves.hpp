// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the planes of the four valves.
#pragma once
#include <map>
#include <string>

#include "generator/landmarks/faint_right_heart.hpp"
#include "generator/landmarks/valve_patch.hpp"

namespace heartgen::landmarks {

/// How the right heart shows in the image.
struct RightHeartLook {
  bool streaks = false;                  ///< it is eaten away by streaks: its tightest place is no valve
  std::optional<FaintRightHeart> faint;  ///< it has little contrast, and was found by that
  double muscle_hu = 0;
};

/// Valves by name (mitral, aortic, tricuspid, pulmonary), as far as their two pools touch. `image` is on the chambers'
/// grid. The border between the right heart's pools moves to the planes that are found.
std::map<std::string, ValvePatch> find_valves(LabelVolume& chambers, const chest::WorkingImage& image,
                                              const LongAxis& axis, const RightHeartLook& right);

}  // namespace heartgen::landmarks
