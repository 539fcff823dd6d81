// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The image stages of a build: landmarks where the recipe gives none, and the label map of a CT.
#pragma once
#include <filesystem>

#include "generator/pipeline/stages.hpp"

namespace heartgen::pipeline {

/// The CT and the given labels, and what these lack. Throws UserError where chambers or ventricular walls are lacking
/// that nothing can add.
Stages input_stages();

/// The recipe's landmarks, completed by those found in the CT where the recipe does not mark all four chambers. Refuse,
/// with a UserError, where a chamber was not found, and what can hardly be a heart unless that is accepted; where given
/// labels lack the great vessels alone, a warning says that they were not found.
Stages landmark_stages();

/// CT to label map. What is known already is not made again and never overwritten.
Stages label_stages();

/// Whether seeds for all four chambers are given, so that none need to be looked for.
bool chambers_are_marked(const Landmarks& landmarks);

/// Whether no labels and no file hold the chambers.
bool takes_chambers_from_ct(const Build& build);

/// Where a picture of refused landmarks goes; empty without an output.
std::filesystem::path picture_beside(const BuildOptions& options);

/// What the finished map says: what was made beside the given labels (no voxels: none), and valves that are closed.
Notes label_notes(const LabelVolume& given, const LabelVolume& heart, bool has_ct);

}  // namespace heartgen::pipeline
