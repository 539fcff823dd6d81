// The lumen of one vessel (a carotid) out of an angiogram.
#pragma once
#include "model/vec.hpp"
#include "model/volume.hpp"

namespace heart::segment {

struct VesselSettings {
  double smoothing_hu = 30;       ///< strength of the total variation smoothing, 0 for none
  double maximum_volume_ml = 60;  ///< more is taken for a leak
};

/// The bright component at the seed, cut half-way between the lumen's grey value and that of its surroundings.
/// Throws UserError for a seed outside the image, or not brighter than its surroundings, and for a leak. Root only.
Mask segment_vessel(const CtVolume& angiogram, const Vec3& seed_mm, const VesselSettings& settings = {});

}  // namespace heart::segment
