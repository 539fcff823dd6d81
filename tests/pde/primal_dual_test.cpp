// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/primal_dual.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::at_threads;
using testing::grid_of;
using testing::length;

/// All fields of a smoothing by total variation after the iterations that `advance` makes.
template <class Advance>
std::vector<parallel::Pages<float>> fields_after(const Volume<float>& image, Advance&& advance) {
  const auto g = testing::slab_of(image);
  auto start = parallel::make_slab_like<float>(g, 0);
  std::ranges::copy(g.owned(), start.owned().begin());
  auto f = pde::make_primal_dual(std::move(start), parallel::self());
  const pde::AxisWeights step = pde::axis_weights(image.grid, 0.3);
  const pde::Run row{0, image.grid.size[0]};
  advance(
      f, [&](std::int64_t j, std::int64_t k) { pde::dual_row(pde::dual_row_of(f, j, k, row), step); },
      [&](std::int64_t j, std::int64_t k) {
        pde::primal_row_l2(pde::primal_row_of(f, j, k, row), step, g.row(j, k), 0.1F);
      });
  return {f.u.values, f.bar.values, f.px.values, f.py.values, f.pz.values};
}

Volume<float> noisy_ball(Index3 size) {
  return testing::noisy(testing::volume_of(grid_of(size, {0.5, 0.7, 1.2}),
                                           [](double x, double y, double z) { return length(x / 40, y, z) < 4; }),
                        0.2);
}

auto after_single_sweeps(const Volume<float>& image, int iterations) {
  return fields_after(image, [&](auto& f, auto&& dual, auto&& primal) {
    for (int n = 0; n < iterations; ++n) pde::primal_dual_sweep(f, parallel::self(), dual, primal);
  });
}

/// Rows so long that a slice takes several blocks of them; slices that one thread, two or three have enough of.
TEST(PrimalDual, PassesHaveTheBitsOfSingleSweeps) {
  constexpr int iterations = 7;
  for (const Index3 size : {Index3{2600, 11, 9}, Index3{2600, 13, 34}, Index3{17, 12, 70}, Index3{33, 1, 16}}) {
    const auto image = noisy_ball(size);
    if (size[0] > 2000) {
      ASSERT_LT(2 * pde::rows_of_block(size[0], 2, pde::bytes_of_primal_dual), size[1]);
    }
    const auto single = after_single_sweeps(image, iterations);
    const auto results = at_threads([&] {
      return fields_after(image, [&](auto& f, auto&& dual, auto&& primal) {
        pde::primal_dual_sweeps(f, iterations, parallel::self(), dual, primal);
      });
    });
    for (const auto& result : results) EXPECT_EQ(result, single) << size[0] << ' ' << size[2];
  }
}

/// Pieces as thin as a pass allows, and blocks with fewer rows than a pass has iterations.
TEST(PrimalDual, APassOfAnyDepthHasTheBitsOfSingleSweeps) {
  for (const int depth : {2, 3, 4, 7})
    for (const std::int64_t rows : {3, 23}) {
      const auto image = noisy_ball({1200, rows, 2 * 3 * depth});
      const auto single = after_single_sweeps(image, depth);
      const auto results = at_threads([&] {
        return fields_after(image, [&](auto& f, auto&& dual, auto&& primal) {
          pde::primal_dual_pass(f, depth, parallel::self(), dual, primal);
        });
      });
      for (const auto& result : results) EXPECT_EQ(result, single) << depth << ' ' << rows;
    }
}

}  // namespace
}  // namespace heartgen::pde
