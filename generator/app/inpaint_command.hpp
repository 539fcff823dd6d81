// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen inpaint`: fills the gaps in an image of fibre axes.
#pragma once
#include <string>
#include <vector>

#include "generator/parallel/comm.hpp"

namespace heartgen::app {

struct InpaintCommand {
  std::string input, labels, output;  ///< folders with fiber_x.nrrd, fiber_y.nrrd, fiber_z.nrrd; a label map
  std::vector<std::string> regions{"lv_myocardium", "rv_myocardium"};
  int iterations = 200;
  bool json = false;
};

/// Total variation inpainting of axes (thesis 9.3) wherever a voxel of the regions has none; the same bits for any
/// number of ranks. @collective
int inpaint_command(const InpaintCommand& command, const parallel::Comm& comm);

}  // namespace heartgen::app
