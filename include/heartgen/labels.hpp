// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Label maps: an image with the tag of a region in each voxel, 0 outside; the tables of regions and surfaces
/// (model/labels.hpp). Not collective; everything throws UserError.
#pragma once
#include <string>
#include <vector>

#include "model/certificate.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen {

struct LabelMap {
  LabelVolume labels;             ///< tags of model/labels.hpp
  std::vector<Warning> warnings;  ///< what was resampled or not used
};

/// Label maps of other programs. `path` is an image, or a folder with one mask per structure; `preset` says what values
/// and names mean (see label_preset_names), `names` is a table of them (.csv or .json; may be empty).
LabelMap read_label_map(const std::string& path, const std::string& preset = "heartgen", const std::string& names = "");

std::vector<std::string> label_preset_names();

}  // namespace heartgen
