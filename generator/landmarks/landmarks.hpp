// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Seeds, valve planes and the long axis of the left ventricle, found in a contrast-enhanced CT without a click (in
/// place of the clicks of thesis 6.2).
#pragma once
#include <map>
#include <string>
#include <vector>

#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::landmarks {

/// What was found, and how far to trust it. Everything in LPS mm.
struct FoundLandmarks {
  /// Seeds lv_blood, rv_blood, la_blood, ra_blood, aorta, pulmonary_artery and trachea, each at the deepest point of
  /// its pool (a pool that was not found has none); those valves whose two pools touch; the epicardial apex.
  Landmarks landmarks;
  double confidence = 0;                     ///< 0 to 1: 1 = nothing contradicts the anatomy of an adult heart
  std::vector<std::string> warnings;         ///< one sentence for every contradiction
  std::map<std::string, double> volumes_ml;  ///< of the pools, by region name, within 110 mm of the heart's centre
  double ventricles_cut_cm2 = 0;             ///< by the border of the field of view, as far as their blood tells
  Vec3 long_axis;                            ///< unit vector from the left ventricle's base to its apex
};

/// `ct` shows the whole heart and lungs beside it; the field of view may end before the spine. Grids of any spacing,
/// orientation and direction; padding that cuts lungs open is closed beforehand (anatomy/padding.hpp). The same bits
/// for any number of threads. Throws UserError for grey values that are no Hounsfield units, and, saying which seeds to
/// give by hand, where there is no contrast, no heart, no pool with a shell of muscle, or no left atrium and aorta next
/// to it. Not collective: call it on the root.
FoundLandmarks find_landmarks(const CtVolume& ct);

}  // namespace heartgen::landmarks
