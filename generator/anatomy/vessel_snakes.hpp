// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The lumen of one vessel (a carotid) by a closed snake in every slice (thesis 8.3.3: threshold, snake, smoothing by
/// total variation).
#pragma once
#include "model/priors.hpp"
#include "model/tissue.hpp"
#include "model/vec.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

struct VesselSnakeSettings {
  double smoothing_hu = 30;        ///< total variation smoothing before the threshold, as in anatomy::VesselSettings
  double edge_smoothing_mm = 0.4;  ///< of the slice, before its edges are taken
  double edge_hu_per_mm = tissue::carotid_edge_hu_per_mm;  ///< gradient at which the edge function falls to a half
  double final_smoothing_mm = 0.1;                         ///< weight of the lumen's surface in the last step, 0: none
  double maximum_volume_ml = priors::carotid_max_ml;       ///< more is taken for a leak
};

/// The bright component at the seed, cut half-way between its grey value and that of its surroundings; in every slice a
/// snake from the outline of each of its pieces to the edge; last a smoothing of the stack by total variation. Pieces
/// too small for a snake, and those whose snake does not settle, stay as the threshold has them.
/// Throws UserError as anatomy::segment_vessel does. Root only.
Mask segment_vessel_by_snakes(const CtVolume& angiogram, const Vec3& seed_mm, const VesselSnakeSettings& settings = {});

}  // namespace heartgen::anatomy
