// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Tables of label names: "52 is the aorta".
#pragma once
#include <cstdint>
#include <map>
#include <string>

namespace heartgen::labels {

/// Reads value and name of every structure from
/// .csv: with a header, a column "id", "value", "label", "index" or "labelvalue" and a column "structure", "name",
///       "region", "label_name" or "labelname"; without one, two columns in either order;
/// .json: {"1": "spleen", ...}, {"spleen": 1, ...}, or one of these as the member "labels".
/// Throws UserError naming file and line for anything else, and for a value that stands twice.
std::map<std::int32_t, std::string> read_label_names(const std::string& path);

}  // namespace heartgen::labels
