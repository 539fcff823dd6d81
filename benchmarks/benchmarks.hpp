// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The measured speeds of the image stages, next to the limits of the machine they run on. Nothing here is a test:
/// figures depend on the machine and on what else it does.
#pragma once
#include <functional>

#include "benchmarks/measure.hpp"
#include "generator/parallel/comm.hpp"
#include "model/grid.hpp"

namespace heartgen::benchmarks {

struct Settings {
  Index3 size{512, 512, 199};  ///< of the images that `ranks`, `segment` and `epicardium` work on
  Vec3 spacing_mm{0.5, 0.5, 1.2};
  int repeats = 7;           ///< of the short ones, of which the median counts
  int threads = 2;           ///< most threads that are used
  std::string labels;        ///< label map for the mesh benchmarks; empty: a phantom's
  int variant = 0;           ///< of that phantom
  double heart_edge_mm = 0;  ///< of `mesh-myocardium` and `mesh-heart`; 0: for about 1.25 million cells in the walls
};

struct Benchmark {
  std::string name;
  std::string help;
  Table (*run)(const Settings& settings, const parallel::Comm& comm);  ///< @collective; every rank gets the table
};

/// All of them, in the order in which they run.
const std::vector<Benchmark>& all();

// Each @collective; `sweep`, `segment` and `epicardium` measure this process's share of the work with the threads of
// the settings, `ranks` compares all ranks with the root alone, at one thread each.
Table bench_sweep(const Settings& settings, const parallel::Comm& comm);
Table bench_ranks(const Settings& settings, const parallel::Comm& comm);
Table bench_segment(const Settings& settings, const parallel::Comm& comm);
Table bench_epicardium(const Settings& settings, const parallel::Comm& comm);

// On the root only; sizes are their own.
// On the root only.
// The confidence of automatic landmarks against right and wrong.
Table bench_confidence(const Settings& settings, const parallel::Comm& comm);

Table bench_mesh_scaling(const Settings& settings, const parallel::Comm& comm);
Table bench_mesh_ventricles(const Settings& settings, const parallel::Comm& comm);
Table bench_mesh_myocardium(const Settings& settings, const parallel::Comm& comm);
Table bench_mesh_walls(const Settings& settings, const parallel::Comm& comm);
Table bench_mesh_backends(const Settings& settings, const parallel::Comm& comm);
Table bench_mesh_heart(const Settings& settings, const parallel::Comm& comm);
Table bench_mesh_torso(const Settings& settings, const parallel::Comm& comm);
Table bench_mesh_vessels(const Settings& settings, const parallel::Comm& comm);
Table bench_mesh_slice(const Settings& settings, const parallel::Comm& comm);
Table bench_exports(const Settings& settings, const parallel::Comm& comm);

}  // namespace heartgen::benchmarks
