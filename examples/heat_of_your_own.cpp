// SPDX-License-Identifier: GPL-3.0-or-later
// A filter of your own: written for rows of a slab, it runs in 2D and 3D, on threads and on any number of ranks.
#include <algorithm>
#include <heartgen/pde.hpp>

#include "images.hpp"

namespace {

using namespace heartgen;

/// One explicit step of the heat equation on voxels of 1 mm.
void heat_step(parallel::Slab<float>& image, float time_step, const parallel::Comm& comm) {
  parallel::exchange_halo(image, comm);  // beyond the image its border slice is repeated
  const auto nx = image.grid.size[0], ny = image.grid.size[1];
  const auto before = image;
  parallel::for_rows(image, [&](std::int64_t j, std::int64_t k) {
    const float* row = before.row(j, k);
    const float* beside[] = {before.row(std::max<std::int64_t>(j - 1, 0), k), before.row(std::min(j + 1, ny - 1), k),
                             before.row(j, k - 1), before.row(j, k + 1)};
    float* out = image.row(j, k);
    for (std::int64_t i = 0; i < nx; ++i) {
      float sum = row[std::max<std::int64_t>(i - 1, 0)] + row[std::min(i + 1, nx - 1)] - 6 * row[i];
      for (const float* other : beside) sum += other[i];
      out[i] = row[i] + time_step * sum;
    }
  });
}

double total(const parallel::Slab<float>& image, const parallel::Comm& comm) {
  return parallel::sum_rows(image, comm, [&](std::int64_t j, std::int64_t k) {
    double sum = 0;
    for (std::int64_t i = 0; i < image.grid.size[0]; ++i) sum += static_cast<double>(image.row(j, k)[i]);
    return sum;
  });
}

}  // namespace

int main(int argc, char** argv) {
  const parallel::Environment environment(&argc, &argv);
  const auto comm = parallel::world();
  const auto image = parallel::run_on_root(comm, [] { return noisy_ball(grid_of(32, 32), 8, 50); });
  auto slab = parallel::scatter(image, comm);
  const double before = total(slab, comm);
  for (int step = 0; step < 20; ++step) heat_step(slab, 0.15F, comm);
  return expect_near("heat", total(slab, comm), before, 1e-5);
}
