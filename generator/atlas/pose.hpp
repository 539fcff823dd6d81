// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Affine alignment of the atlas with the patient: long axes and RV sides first, then least squares on distance maps.
/// Not collective.
#pragma once
#include "generator/adapters/ceres_pose.hpp"
#include "generator/ventricles/ventricles.hpp"

namespace heartgen::atlas {

struct Pose {
  AffineMap atlas_from_patient;  ///< position in the atlas's frame (mm) of a position in the patient's (mm)
  double rms_mm = 0;             ///< misfit of the distance maps (left hull, left cavity, right cavity, both hulls),
                                 ///< each clipped at 6 mm
};

/// The map that takes long axis to long axis, RV side to RV side and volume to volume. A proper rotation and a scale:
/// it cannot mirror.
AffineMap pose_from_frames(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas);

struct CommonParts {
  Volume<std::uint8_t> patient, atlas;  ///< each on its own grid
};

/// Both hearts as far up as both are known. With its base, each ends at its own base plane. A patient whose base is cut
/// off has none that says anything about the atlas's: then both end at the cut and at the atlas's base plane.
CommonParts common_parts(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas,
                         const AffineMap& atlas_from_patient);

/// Throws UserError when the hearts do not overlap afterwards (rms above 5 mm).
Pose fit_atlas_pose(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas);

}  // namespace heartgen::atlas
