// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A heart in another patient's torso (thesis 8.3.5). The heart and its grid stay where they are, so that landmarks,
/// fibres and grey values still belong to them; the torso is brought to the heart.
#pragma once
#include <string>
#include <vector>

#include "generator/adapters/ceres_pose.hpp"
#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::labels {

/// A place that both patients have.
struct CommonMark {
  std::string name;
  Vec3 heart_mm;  ///< in the heart's image, LPS
  Vec3 torso_mm;  ///< in the torso's image, LPS
};

/// The centres of the four chambers where both label maps have them, the centres of the valves and the apex where both
/// landmarks have them. Throws UserError for fewer than three, or where all lie on one line.
std::vector<CommonMark> common_marks(const LabelVolume& heart, const Landmarks& heart_landmarks,
                                     const LabelVolume& torso, const Landmarks& torso_landmarks);

struct TorsoPose {
  AffineMap torso_from_heart;
  double scale = 1;                 ///< of the torso against the heart
  double rms_mm = 0;                ///< of the marks, in the torso
  std::vector<double> residual_mm;  ///< of each mark
};

/// Rotation and shift, and one scale with `with_scale`, by least squares.
TorsoPose fit_torso(const std::vector<CommonMark>& marks, bool with_scale);

struct PlacedHeart {
  LabelVolume labels;        ///< the heart's grid, continued until it holds the whole torso
  double outside_share = 0;  ///< of the heart: beyond the torso's body
  double bone_share = 0;     ///< of the heart: in the torso's bone
};

/// Regions of the heart from `heart`, everything else from `torso` at its nearest voxel; where that has a heart of its
/// own, it is filled as torso. Throws UserError where more than a tenth of the heart lies outside the body.
PlacedHeart place_heart(const LabelVolume& heart, const LabelVolume& torso, const TorsoPose& pose);

}  // namespace heartgen::labels
