// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Given labels that cannot be a heart: another task's numbers, volumes of no heart, organs inside the heart, and a
/// heart that lies where the CT has none.
#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "generator/adapters/itk_io.hpp"
#include "generator/labels/presets.hpp"
#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::labels {

/// Whether the left ventricle's blood lies in its wall, no regions are exchanged, and the ventricles' volumes are those
/// of one heart. Labels without left blood or wall say no.
bool looks_like_heart(const LabelVolume& labels);

/// Throws UserError where `labels`, the image as `preset` reads it, look like no heart and another preset makes a heart
/// of the same values: it is named.
void refuse_another_task(const adapters::LabelImage& image, const LabelVolume& labels, const LabelPreset& preset,
                         const std::string& path);

/// Without 0, ascending.
std::set<std::int32_t> values_in(const Volume<std::int32_t>& layer);

/// The presets that make a heart of the image's values, in the order of label_presets().
std::vector<std::string> fitting_presets(const adapters::LabelImage& image);
/// The first of them; empty where there is none.
std::string fitting_preset(const adapters::LabelImage& image);

/// Throws UserError for chambers that no heart with a left ventricle's wall has side by side, such as a right ventricle
/// of 3 ml at a left one of 120 ml, and for exchanged regions (swapped_labels.hpp).
void refuse_no_heart(const LabelVolume& labels, const std::string& path);

/// Throws UserError, naming `path`, where more than a tenth of the labels' heart lies in air or lung of the CT, or much
/// of its muscle is as bright as its blood, as after a mistake between LPS and RAS or with another patient's labels.
/// Both are on one grid.
void refuse_labels_beside_heart(const LabelVolume& labels, const CtVolume& ct, const std::string& path);

/// Throws UserError where given liver, bone, lung or trachea fills the chambers, or the left ventricle's wall, of
/// `chambers` that were found in the CT.
void refuse_organs_in_heart(const LabelVolume& given, const LabelVolume& chambers, const std::string& path);

}  // namespace heartgen::labels
