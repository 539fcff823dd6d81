// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// heartgen slice: the mesh of one transverse slice.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace heartgen::app {

struct SliceCommand {
  std::string input, output;  ///< label map or folder of a bundle; mesh to write (.vtu or .msh)
  std::optional<std::int64_t> index;
  std::optional<double> z_mm;
  std::optional<double> edge_mm, torso_edge_mm, growth;
  bool json = false;
};

/// Exit code 3 when an angle is outside [28, 120] degrees. Not collective.
int slice_command(const SliceCommand& command);

}  // namespace heartgen::app
