// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where every point of the patient's ventricles lies in the atlas: affine pose, then diffeomorphic demons on label
/// images (thesis 9.1, 9.2; the images hold one value per part instead of muscle | rest). Not collective.
#pragma once
#include "generator/atlas/pose.hpp"
#include "model/recipe.hpp"

namespace heartgen::atlas {

struct Registration {
  Pose pose;
  Mat3 rotation;                 ///< nearest to the pose's matrix: where the patient's directions point in the atlas
  Volume<Vec3> displacement_mm;  ///< u on the registration grid, in the patient's frame
  double min_jacobian = 0;       ///< smallest determinant of the gradient of x + u(x) on that grid; > 0: no folding
  double wall_overlap = 0;       ///< Dice of the walls below the base, patient against warped atlas
};

/// `patient` and `atlas` on grids at least as fine as settings.grid_mm, the spacing of the registration grid.
Registration register_atlas(const ventricles::Ventricles& patient, const ventricles::Ventricles& atlas,
                            const FiberSettings& settings);

/// Position in the atlas's frame, mm.
Vec3 atlas_position(const Registration& registration, const Vec3& patient_mm);

/// Its derivative by the patient's coordinates.
Mat3 atlas_jacobian(const Registration& registration, const Vec3& patient_mm);

/// The rotation nearest to a matrix of positive determinant: what it does besides stretching.
Mat3 nearest_rotation(Mat3 matrix);

}  // namespace heartgen::atlas
