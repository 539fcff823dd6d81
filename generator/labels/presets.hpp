// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the values and names of well-known label maps mean.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/labels.hpp"

namespace heartgen::labels {

/// A structure that a preset knows; Region::none: known, and of no use to a heart model.
struct KnownStructure {
  std::string name;
  Region region = Region::none;
};

struct LabelPreset {
  std::string_view name;
  std::string_view what;                          ///< one line for the help
  std::map<std::int32_t, KnownStructure> values;  ///< value to structure
  std::map<std::string, Region> names;            ///< plain name (see plain_name) to region, more than `values` has
  bool knows_words = false;                       ///< names are understood by their words, too (usual_names.hpp)
};

/// What a preset makes of a name; nothing where it does not know it.
std::optional<Region> region_of_name(const LabelPreset& preset, std::string_view name);

/// The first preset that knows all names and makes a region of one; else, of those that make a region of one, the first
/// that knows the most; null where none does.
const LabelPreset* preset_for_names(const std::vector<std::string>& names);

/// Stands for whichever makes a heart of the names and values.
inline constexpr std::string_view automatic_preset = "auto";

/// heartgen: the tags and names of labels.hpp.
/// totalsegmentator, totalsegmentator_v1, totalsegmentator_heart: the tasks `total` of versions 2 and 1 and
/// `heartchambers_highres`, values as its class map numbers them (github.com/wasserth/TotalSegmentator,
/// totalsegmentator/map_to_binary.py); all three know the structures of all three by name, as its files are called.
/// mm_whs: the Multi-Modality Whole Heart Segmentation challenge (Zhuang and Shen 2016; 421 stands for 420 in one of
/// its files). imagechd: the data set of that name (Xu and others 2020), and MM-WHS in numbers from 1 on.
/// names: what people call structures (usual_names.hpp).
const std::vector<LabelPreset>& label_presets();

/// Throws UserError with the nearest known name. "none" is a preset without any meaning.
const LabelPreset& label_preset(std::string_view name);

/// Lower case, with every run of other characters than letters and digits as one '_': how names are compared. Letters
/// of other scripts than the Latin stay as they are (UTF-8).
std::string plain_name(std::string_view name);

}  // namespace heartgen::labels
