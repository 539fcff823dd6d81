// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// heartgen transfer: the fibres of one mesh on another mesh of the same heart.
#pragma once
#include <string>

namespace heartgen::app {

struct TransferCommand {
  std::string source;  ///< folder of a bundle, or any mesh (any_mesh.hpp) with "fiber" and "sheet" on its points
  std::string input, output;
  double search_mm = 5;  ///< how far a node may lie from the source
  bool partial = false;  ///< leave nodes farther away without fibres instead of refusing
  bool json = false;
};

/// Writes `input` with the arrays "fiber", "sheet", "sheet_normal" on points and cells and "fiber_source" on points;
/// its other arrays stay, as float64 or int32. Throws UserError, before anything is written.
int transfer_command(const TransferCommand& command);

}  // namespace heartgen::app
