// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen-lab sensitivity`: what each number about patients does.
#pragma once
#include <string>
#include <vector>

#include "model/grid.hpp"

namespace heartgen::lab {

struct SensitivityCommand {
  std::vector<std::string> only;    ///< numbers to move; empty: all
  std::vector<std::string> stages;  ///< to run, with those that they need; empty: all
  int phantoms = 1;                 ///< variants 0 to this, less one
  double change = 20;               ///< percent, up and down
  Index3 size{124, 120, 100};       ///< of the phantoms' CT
  Vec3 spacing_mm{1.8, 1.8, 1.8};
  double noise_hu = 22;
  bool list = false;  ///< only print the numbers, as docs/numbers.md has them
  bool json = false;
};

/// A row per number and change: the greatest change of Dice of chambers, walls, body and carotid, of the walls' mean
/// surface distance, of a volume and of the fibres' mean angle to the known ones, over all phantoms; the numbers that
/// change most first; then the names of those that change nothing, and of those that no stage reads. Progress goes to
/// stderr. Throws UserError for an unknown number or stage and for a change outside of 0 to 100. Serial per rank
/// (threads inside).
int sensitivity_command(const SensitivityCommand& command);

}  // namespace heartgen::lab
