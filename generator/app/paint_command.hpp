// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen paint`: regions of the user's own on the cells of any mesh.
#pragma once
#include <string>
#include <vector>

namespace heartgen::app {

struct PaintCommand {
  std::string input, output;
  std::vector<std::string> regions;  ///< FILE, FILE:NAME or FILE:NAME,NAME
  std::vector<std::string> only;     ///< tags or names of the mesh's regions that are painted; empty: all
  std::string region;                ///< the array with the mesh's regions; empty: a known name
  bool json = false;
};

/// Returns the exit code. Throws UserError.
int paint_command(const PaintCommand& command);

}  // namespace heartgen::app
