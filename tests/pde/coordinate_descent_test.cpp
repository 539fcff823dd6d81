// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/coordinate_descent.hpp"

#include <gtest/gtest.h>

#include "generator/pde/chan_vese.hpp"
#include "generator/pde/primal_dual.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::grid_of;
using testing::slab_of;
const auto alone = parallel::self();

/// A random start on a domain with holes: the energy falls, and no single voxel can lower it any more.
TEST(Descend, EndsWhereNoVoxelLowersTheEnergy) {
  for (const Index3 size : {Index3{13, 11, 7}, Index3{19, 17, 1}, Index3{5, 1, 1}}) {
    const Grid grid = grid_of(size, {0.8, 0.8, 1.2});
    const auto image = slab_of(testing::noisy(testing::ball(grid, 3), 0.6));
    const auto domain = slab_of(testing::volume_of<std::uint8_t>(
        grid, [](double x, double y, double z) { return std::sin(2 * x + y) + std::cos(z + x) > -0.9 ? 1 : 0; }));
    auto start = testing::volume_of<std::uint8_t>(
        grid, [](double x, double y, double z) { return std::sin(12.9 * x + 78.2 * y + 37.7 * z) > 0 ? 1 : 0; });
    for (std::size_t i = 0; i < start.voxels.size(); ++i) start.voxels[i] &= domain.owned()[i];
    const pde::ChanVeseSettings settings{.mu = 0.7};
    const auto energy = [&](const parallel::Slab<std::uint8_t>& above) {
      return pde::chan_vese_energy(image, domain, above, 0, 1, settings, alone);
    };
    const auto strength = static_cast<float>(pde::smallest_spacing(grid) / settings.mu);
    auto above = slab_of(start);
    const double before = energy(above);
    pde::descend_coordinates(image, domain, {2 * strength, 0.5f, strength}, pde::axis_weights(grid),
                             pde::row_runs(domain, [](std::uint8_t) { return true; }), 100, above, alone);
    const double after = energy(above);
    EXPECT_LE(after, before);
    for (std::size_t i = 0; i < above.owned().size(); ++i) {
      if (!domain.owned()[i]) {
        EXPECT_EQ(above.owned()[i], 0);
        continue;
      }
      auto other = above;
      other.owned()[i] ^= 1;
      parallel::exchange_halo(other, alone);
      EXPECT_GE(energy(other), after - 1e-5) << i;
    }
  }
}

}  // namespace
}  // namespace heartgen::pde
