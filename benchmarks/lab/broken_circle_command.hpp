// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen-lab broken-circle`: deformable contours on the broken circle (thesis Fig 4.6).
#pragma once
#include <string>

namespace heartgen::lab {

struct BrokenCircleCommand {
  std::string folder;  ///< where the pictures go
  double noise = 0;    ///< standard deviation, of 255
  bool json = false;
};

/// One picture per method over the broken circle, and φ of the subjective surface.
int broken_circle_command(const BrokenCircleCommand& command);

}  // namespace heartgen::lab
