// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Points and planes that tell the chambers apart.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "model/vec.hpp"

namespace heartgen {

/// A valve orifice: a disc. The normal points out of the ventricle (to the atrium or into the artery).
struct ValvePlane {
  Vec3 center_mm;
  Vec3 normal;
  double radius_mm = 0;
};

struct Landmarks {
  /// Region name (lv_blood, rv_blood, la_blood, ra_blood, aorta, pulmonary_artery, trachea, carotid) to a point inside.
  std::map<std::string, Vec3> seeds_mm;
  /// mitral, aortic, tricuspid, pulmonary
  std::map<std::string, ValvePlane> valves;
  std::optional<Vec3> lv_apex_mm;  ///< epicardial apex of the left ventricle
};

}  // namespace heartgen
