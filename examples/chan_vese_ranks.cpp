// SPDX-License-Identifier: GPL-3.0-or-later
// Chan-Vese on any number of processes: mpirun -n 4 ./chan_vese_ranks. The result has the same bits as on one.
#include <heartgen/pde.hpp>

#include "images.hpp"

int main(int argc, char** argv) {
  using namespace heartgen;
  const parallel::Environment environment(&argc, &argv);
  const auto comm = parallel::world();
  const pde::ChanVeseSettings settings{.mu = 1};
  // The image is on the root; every rank gets its slices.
  const auto image = parallel::run_on_root(comm, [] { return noisy_ball(grid_of(64, 48), 20, 80); });
  const auto domain = parallel::run_on_root(comm, [&] { return Mask(image.grid, 1); });
  const auto slab = parallel::scatter(image, comm);
  const auto found = pde::chan_vese(slab, parallel::scatter(domain, comm), settings, comm);
  const auto above = parallel::gather(found.above, comm);
  int differs = 0;
  parallel::run_on_root(comm, [&] {
    std::printf("%d ranks, %d sweeps, %.0f voxels above\n", comm.size, found.iterations, count(above));
    differs = pde::chan_vese(image, domain, settings, parallel::self()).above.voxels != above.voxels;
  });
  parallel::broadcast(comm, differs);
  return differs;
}
