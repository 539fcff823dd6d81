// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The image stages of a build: landmarks where the recipe gives none, and the label map of a CT.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "generator/anatomy/padding.hpp"
#include "generator/labels/given_labels.hpp"
#include "generator/pipeline/run.hpp"
#include "model/certificate.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::pipeline {

/// What is known of the label map before the image stages begin, and what they must add.
struct KnownLabels {
  Staged<labels::GivenLabels> given{};                     ///< no voxels: nothing is given. Root only
  labels::MissingGroups missing{true, false, true, true};  ///< on every rank
};

/// Closes what was not measured of a CT where cut lungs open into it, unless labels are given. Root only has the
/// voxels. @collective
anatomy::Padding close_unmeasured(Run& run, Staged<CtVolume>& ct, const Recipe& recipe, std::vector<Warning>& warnings);

/// Whether seeds for all four chambers are given, so that none need to be looked for.
bool chambers_are_marked(const Landmarks& landmarks);

/// What to do with automatic landmarks that can hardly be a heart's.
struct Doubt {
  bool is_accepted = false;         ///< go on, and mark the model
  std::filesystem::path picture{};  ///< where a picture of what was found is written before they are refused
};

struct CompletedLandmarks {
  Landmarks landmarks;
  double ventricles_cut_cm2 = 0;  ///< as far as a search has seen that. Root only
};

/// The recipe's landmarks, completed by those found in the CT where the recipe does not mark all four chambers.
/// What the recipe gives wins. Warnings above a note are printed at once. Throws UserError where a chamber was not
/// found, and for what can hardly be a heart unless that is accepted. @collective
CompletedLandmarks complete_landmarks(Run& run, const Staged<CtVolume>& ct, const Landmarks& given,
                                      std::vector<Warning>& warnings, const Doubt& doubt = {});

/// Completes the landmarks for the great vessels that given labels lack; false, with a warning, where the CT does not
/// show them. @collective
bool find_vessels(Run& run, const Staged<CtVolume>& ct, Landmarks& landmarks, std::vector<Warning>& warnings);

/// What the finished map says: what was made beside the given labels (no voxels: none), and valves that are closed.
/// Root only.
std::vector<Warning> label_warnings(const LabelVolume& given, const LabelVolume& heart, bool has_ct);

/// Reads the recipe's `input.labels`, if any, on the CT's grid; `hash` stands for the files' contents. Without a CT
/// (no voxels) they keep their own grid, and what only a CT could add is missing no more, which the warnings say.
/// Throws UserError where chambers or ventricular walls are lacking that nothing can add. @collective
KnownLabels read_known_labels(Run& run, const Staged<CtVolume>& ct, const Recipe& recipe, const std::string& hash,
                              std::vector<Warning>& warnings);

/// The image stages: CT to label map. What is known already is not made again and never overwritten. No stage labels
/// the `padding`, but a file that replaces a stage may. @collective
Staged<LabelVolume> label_ct(Run& run, const Staged<CtVolume>& ct, const Recipe& recipe, const KnownLabels& known = {},
                             const anatomy::Padding& padding = {});

}  // namespace heartgen::pipeline
