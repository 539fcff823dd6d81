// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen segment`: the recipe's tree of splits on any image, 2D or 3D.
#pragma once
#include <string>

#include "generator/parallel/comm.hpp"

namespace heartgen::app {

struct SegmentCommand {
  std::string recipe, image, output;
  bool json = false;
};

/// Denoises the image and runs the recipe's segmentation steps; writes the leaves of the tree as a label image (the
/// same grid, one value per leaf, 0 in no step's domain) and prints the steps and leaves. @collective
int segment_command(const SegmentCommand& command, const parallel::Comm& comm);

}  // namespace heartgen::app
