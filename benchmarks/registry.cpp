#include "benchmarks/benchmarks.hpp"

namespace heart::benchmarks {

const std::vector<Benchmark>& all() {
  static const std::vector<Benchmark> list{
      {"sweep", "one sweep of each PDE against the memory bandwidth, and ITK's dense Chan-Vese", bench_sweep},
      {"ranks", "the PDE stages on all ranks against one (run under mpirun)", bench_ranks},
      {"segment", "denoising and the default tree of L1 Chan-Vese splits on a phantom", bench_segment},
      {"epicardium", "the walls of the ventricles and atria as minimal cuts on a phantom", bench_epicardium},
      {"mesh", "the lattice mesher on analytic ventricles and random walls, next to CGAL; scaling", bench_mesh},
  };
  return list;
}

}  // namespace heart::benchmarks
