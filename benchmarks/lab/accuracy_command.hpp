// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen-lab accuracy`: phantoms made in memory, segmented without any landmark, compared with what they are.
#pragma once
#include <string>
#include <vector>

#include "datasets/phantom/anatomy.hpp"
#include "generator/parallel/comm.hpp"
#include "model/grid.hpp"

namespace heartgen::lab {

struct AccuracyCommand {
  std::string variants = "0-14";  ///< numbers and ranges, separated by commas
  std::vector<double> noise_hu{22};
  Index3 size{256, 256, 160};
  Vec3 spacing_mm{1.4, 1.4, 1.9};
  phantom::HeartOverrides heart;  ///< of every variant
  std::string keep;               ///< folder for each case's CT, truth and label map; empty: none are written
  bool resume = false;            ///< take from `keep` the phantoms that an earlier run with the same grid measured
  std::string plot;               ///< SVG to write: Dice of every region over the right heart's contrast; empty: none
  bool json = false;
  std::string of = "chambers";  ///< or a part of accuracy_parts.hpp
};

/// One row per phantom: Dice and mean surface distance of ventricles and atria, distance and angle of each valve's
/// plane, angle of the long axis, confidence, seconds; then the worst of each and the rows that miss their bounds. Exit
/// code 3 where a row misses. Throws UserError for variants it cannot read, phantoms out of range, `resume` without
/// `keep`, and a plot that cannot be written. @collective
int accuracy_command(const AccuracyCommand& command, const parallel::Comm& comm);

}  // namespace heartgen::lab
