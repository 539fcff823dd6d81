// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/benchmarks.hpp"

namespace heartgen::benchmarks {

const std::vector<Benchmark>& all() {
  static const std::vector<Benchmark> list{
      {"sweep", "one sweep of each PDE against the memory bandwidth, and ITK's dense Chan-Vese", bench_sweep},
      {"ranks", "the PDE stages on all ranks against one (run under mpirun)", bench_ranks},
      {"segment", "denoising and the default tree of L1 Chan-Vese splits on a phantom", bench_segment},
      {"epicardium", "the walls of the ventricles and atria as minimal cuts on a phantom", bench_epicardium},
      {"confidence", "the confidence of landmarks against right and wrong, on phantoms and spoiled scans",
       bench_confidence},
      {"mesh-scaling", "the lattice mesher from 100 k to 20 M cells, as far as memory goes", bench_mesh_scaling},
      {"mesh-ventricles", "1.25 M cells of analytic ventricles, next to CGAL's Mesh_3", bench_mesh_ventricles},
      {"mesh-myocardium", "the walls of a label map as five regions, next to CGAL's Mesh_3", bench_mesh_myocardium},
      {"mesh-walls", "200 random walls of three materials", bench_mesh_walls},
      {"mesh-backends", "the heart of a label map by every back end of the mesher", bench_mesh_backends},
      {"mesh-heart", "the same walls with the blood in them", bench_mesh_heart},
      {"mesh-torso", "heart and torso of a label map: angles, distances, volumes", bench_mesh_torso},
      {"mesh-vessels", "trachea of a label map and a carotid of 540 k cells, next to CGAL", bench_mesh_vessels},
      {"mesh-slice", "the 2D thorax slice of thesis 8.3.1", bench_mesh_slice},
      {"exports", "1.25 M cells with fibres in every export format: seconds, size, memory", bench_exports},
  };
  return list;
}

}  // namespace heartgen::benchmarks
