// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The lumen of one vessel (a carotid) out of an angiogram, in the three steps of thesis 8.3.3: a threshold, a contour
/// that moves to the edge, and a smoothing by total variation.
#pragma once
#include "model/priors.hpp"
#include "model/vec.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

struct VesselSettings {
  double smoothing_hu = 30;   ///< strength of the total variation smoothing before the threshold, 0 for none
  double curvature_mm = 0.1;  ///< weight of the lumen's surface: tubes with radii below twice this vanish
  double maximum_volume_ml = priors::carotid_max_ml;  ///< more is taken for a leak
};

/// The lumen at the seed. The bright component at the seed, cut half-way between its grey value and that of its wider
/// surroundings, says where the vessel is; its surface then lies where the image falls most steeply along its normals:
/// at a grey value that is measured there, averaged over a few millimetres of the vessel, and so follows a wall, fat or
/// muscle beyond it and a contrast that fades along it.
/// Throws UserError for a seed outside the image, or not brighter than its surroundings, and for a leak. Root only.
Mask segment_vessel(const CtVolume& angiogram, const Vec3& seed_mm, const VesselSettings& settings = {});

struct VesselThreshold {
  Mask lumen;
  Volume<float> smooth;  ///< the image after its total variation smoothing
  double lumen_hu = 0, around_hu = 0;
};

/// The first step alone: the bright component at the seed. Throws as segment_vessel does. Root only.
VesselThreshold threshold_vessel(const CtVolume& angiogram, const Vec3& seed_mm, double smoothing_hu,
                                 double maximum_volume_ml);

/// The last step alone: the component at the seed without holes, after a smoothing by total variation whose weight of
/// the surface is `curvature_mm` (0: none). Root only.
Mask smoothed_lumen(const Mask& rough, const Vec3& seed_mm, double curvature_mm);

}  // namespace heartgen::anatomy
