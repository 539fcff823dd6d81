// Affine alignment of the atlas with the patient: long axes and RV sides first, then least squares on distance maps.
// Not collective.
#pragma once
#include "generator/adapters/ceres_pose.hpp"
#include "generator/atlas/ventricles.hpp"

namespace heart::atlas {

using adapters::AffineMap;

struct Pose {
  AffineMap atlas_from_patient;  ///< position in the atlas's frame (mm) of a position in the patient's (mm)
  double rms_mm = 0;             ///< misfit of the distance maps (left hull, left cavity, right cavity, both hulls),
                                 ///< each clipped at 6 mm
};

/// The map that takes long axis to long axis, RV side to RV side and volume to volume. A proper rotation and a scale:
/// it cannot mirror.
AffineMap pose_from_frames(const Ventricles& patient, const Ventricles& atlas);

/// Throws UserError when the hearts do not overlap afterwards (rms above 5 mm).
Pose fit_atlas_pose(const Ventricles& patient, const Ventricles& atlas);

}  // namespace heart::atlas
