// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Names that people give to structures of the chest in 3D Slicer, ITK-SNAP or Simpleware: "LV blood pool",
/// "Left ventricular wall", "RA", "Ascending aorta".
#pragma once
#include <optional>
#include <string>

#include "model/labels.hpp"

namespace heartgen::labels {

/// What a plain name (see plain_name) means by its words; Region::none: a structure that a heart model does not use.
/// Nothing where a word is unknown, or the words name no structure.
std::optional<Region> region_of_words(const std::string& plain_name);

}  // namespace heartgen::labels
