// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// `heartgen-lab bench`: the measured speeds of the image stages.
#pragma once
#include <string>
#include <vector>

#include "generator/parallel/comm.hpp"
#include "model/grid.hpp"

namespace heartgen::lab {

struct BenchCommand {
  std::vector<std::string> names;  ///< empty: all; "mesh" stands for all whose name begins with "mesh-"
  Index3 size{512, 512, 199};
  Vec3 spacing_mm{0.5, 0.5, 1.2};
  int repeats = 7;
  int threads = 2;
  std::string labels;        ///< label map for the mesh benchmarks; empty: a phantom's
  int variant = 0;           ///< of that phantom
  double heart_edge_mm = 0;  ///< in the walls; 0: for about 1.25 million cells
  bool processor_time = false;
  bool json = false;
};

/// Prints a table, or JSON. Throws UserError for an unknown name. @collective
int bench_command(const BenchCommand& command, const parallel::Comm& comm);

/// The names and what they measure, for --help.
std::string bench_help();

}  // namespace heartgen::lab
