// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Another patient's torso around the heart, as a stage of a build ([torso] of the recipe; thesis 8.3.5).
#pragma once
#include "generator/pipeline/stages.hpp"
#include "model/landmarks.hpp"
#include "model/recipe.hpp"
#include "model/report.hpp"

namespace heartgen::pipeline {

/// Throws UserError for settings that contradict each other, a file that does not exist, and a pose that is not one.
void check_torso(const TorsoSettings& settings);

/// The torso's label map, from its file or by the image stages of its own CT, and the heart in it; nothing where the
/// recipe names no torso. Throws UserError as labels::common_marks and place_heart do.
Stages torso_stages();

/// The recipe's landmarks, and a grid, which stay in the frame of the heart's image, in that of the bundle.
Landmarks landmarks_in_bundle(const Recipe& recipe);
Grid grid_in_bundle(const Recipe& recipe, const Grid& of_heart);

/// A grid, and landmarks, after rotation, shift and one scale.
Grid moved(const Grid& grid, const AffineMap& map);
Landmarks moved(const Landmarks& landmarks, const AffineMap& map);

/// Rows of the certificate: how well both hearts' marks agree, and how much of the heart lies where it should not.
Report torso_rows(const TorsoAround& around);

}  // namespace heartgen::pipeline
