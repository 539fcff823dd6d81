// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What a build can refuse before its first stage: settings that cannot be, files that cannot be read.
#pragma once
#include "generator/anatomy/padding.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::pipeline {

/// The meshes that a recipe can name; "myocardium" is in every bundle.
bool wants(const Recipe& recipe, const std::string& mesh);

/// Throws UserError, naming file and key, for settings out of range or that contradict each other, for files that do
/// not exist, and for those small files that a late stage reads (atlas, carotid, size field, torso) when they cannot be
/// read. The output folder is not looked at.
void check_inputs(const Recipe& recipe);

/// Throws UserError, naming the setting, for edge lengths that are not positive or that no patient's mesh has.
void check_edges(const MeshSettings& settings);

/// Throws UserError for a seed outside the image, telling coordinates that look like RAS or like voxel indices. The
/// carotid's seed belongs to its own angiogram and is not looked at.
void check_seeds_inside(const Grid& grid, const Landmarks& landmarks);

/// Throws UserError where more than the tip of the ventricles lies beyond the image: muscle and blood that were found
/// in the CT end at its border or beside its padding.
void refuse_cut_ventricles(const LabelVolume& labels, const anatomy::Padding& padding);

/// The same from the area that the search for landmarks saw, long before there are labels.
void refuse_cut_ventricles(double cut_cm2);

/// Throws UserError where the labels' heart is the mirror image of a heart, to which the fibre stage could not carry an
/// atlas. Found on a coarse grid, before the meshing; what cannot be seen there is left to that stage.
void refuse_mirrored_heart(const LabelVolume& labels, const Landmarks& landmarks);

/// Throws UserError when the recipe has none.
Vec3 carotid_seed(const Recipe& recipe);

}  // namespace heartgen::pipeline
