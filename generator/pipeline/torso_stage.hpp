// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Another patient's torso around the heart, as a stage of a build ([torso] of the recipe; thesis 8.3.5).
#pragma once
#include <string>
#include <vector>

#include "generator/anatomy/padding.hpp"
#include "generator/labels/place_heart.hpp"
#include "generator/pipeline/run.hpp"
#include "model/certificate.hpp"
#include "model/landmarks.hpp"
#include "model/recipe.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::pipeline {

/// Throws UserError for settings that contradict each other, a file that does not exist, and a pose that is not one.
void check_torso(const TorsoSettings& settings);

/// What the stage hands on. Its label map, like the heart's, is in the frame that the recipe asks for.
struct TorsoAround {
  LabelVolume labels;                ///< heart and torso
  Grid torso_grid;                   ///< of the other patient's image, in the same frame: where its field of view ends
  anatomy::Padding torso_padding{};  ///< of that image, likewise
  labels::TorsoPose pose;
  std::vector<std::string> marks;  ///< names of what the pose was fitted to; empty: the recipe gave it
  double outside_share = 0, bone_share = 0;
};

inline auto members(TorsoAround& t) {
  return std::tie(t.labels, t.torso_grid, t.torso_padding, t.pose, t.marks, t.outside_share, t.bone_share);
}

/// The torso's label map, from its file or by the image stages of its own CT, and the heart in it; nothing where the
/// recipe names no torso. The pose is left in the recipe. Where the bundle has the torso's frame, the grids of the
/// heart's images go there: whatever is made from them is there, too. `torso_hash` stands for the torso's files.
/// Throws UserError as common_marks and place_heart do. The result counts on the root. @collective
Staged<TorsoAround> place_in_torso(Run& run, Staged<LabelVolume>& heart, Grid& ct_grid, Recipe& recipe,
                                   const std::string& torso_hash, std::vector<Warning>& warnings);

/// The recipe's landmarks, and a grid, which stay in the frame of the heart's image, in that of the bundle.
Landmarks landmarks_in_bundle(const Recipe& recipe);
Grid grid_in_bundle(const Recipe& recipe, const Grid& of_heart);

/// A grid, and landmarks, after rotation, shift and one scale.
Grid moved(const Grid& grid, const AffineMap& map);
Landmarks moved(const Landmarks& landmarks, const AffineMap& map);

/// Rows of the certificate: how well both hearts' marks agree, and how much of the heart lies where it should not.
Report torso_rows(const TorsoAround& around);

}  // namespace heartgen::pipeline
