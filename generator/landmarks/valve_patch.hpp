// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the disc in which two pools of blood touch.
#pragma once
#include <optional>

#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::landmarks {

struct ValvePatch {
  Vec3 centre_mm;
  Vec3 normal;             ///< unit, out of the ventricle
  double diameter_mm = 0;  ///< of the disc of the same area
  double uneven_mm = 0;    ///< standard deviation from the plane
  double share = 0;        ///< of the contact that hangs together
  bool hidden = false;     ///< in noise: its place follows from the shape around it
};

/// The largest connected part of the contact between two regions; nothing where they hardly touch.
std::optional<ValvePatch> find_valve_patch(const LabelVolume& chambers, Region ventricle, Region beyond);

}  // namespace heartgen::landmarks
