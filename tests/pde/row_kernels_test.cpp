// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/row_kernels.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "generator/pde/chan_vese.hpp"
#include "generator/pde/continuous_min_cut.hpp"
#include "generator/pde/filters.hpp"
#include "generator/pde/row_loops.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::grid_of;
using testing::slab_of;
const auto alone = parallel::self();

/// The results of work() with the plain code and with each version that this machine has.
template <class Work>
void expect_same_bits(Work&& work) {
  parallel::set_simd_level(parallel::Simd::plain);
  const auto plain = work();
  for (const parallel::Simd level : {parallel::Simd::avx2, parallel::Simd::avx512}) {
    parallel::set_simd_level(level);
    EXPECT_EQ(work(), plain) << name_of(parallel::simd_level());
  }
}

TEST(RowKernels, FiltersHaveTheSameBitsForAnyVectorLength) {
  for (const Index3 size : {Index3{75, 19, 6}, Index3{70, 31, 1}, Index3{3, 2, 2}})
    for (const auto& name : pde::filter_names()) {
      SCOPED_TRACE(name);
      auto image = testing::noisy(testing::ball(grid_of(size, {0.7, 0.7, 1.2}), 5), 0.4);
      image.voxels.front() = -1;  // a zero level, whatever the size
      image.voxels.back() = 1;
      const std::map<std::string, double> few = name == "sobolev" || name == "redistance"
                                                    ? std::map<std::string, double>{}
                                                    : std::map<std::string, double>{{"iterations", 7}};
      expect_same_bits([&] { return pde::apply_filter(name, image, few, alone).voxels; });
    }
}

TEST(RowKernels, SolversHaveTheSameBitsForAnyVectorLength) {
  const Grid grid = grid_of({61, 23, 9}, {0.7, 0.7, 1.2});
  const auto image = testing::noisy(testing::ball(grid, 5), 0.5);
  const auto domain =
      testing::volume_of<std::uint8_t>(grid, [](double x, double y, double) { return x + y < 9 ? 1 : 0; });
  auto weight = image;
  for (auto& w : weight.voxels) w = 1 / (1 + w * w);
  const auto state = testing::volume_of<std::uint8_t>(grid, [](double x, double y, double z) {
    const double r = testing::length(x, y, z);
    return r < 2 ? 2 : r < 6 ? 1 : 0;
  });
  expect_same_bits([&] { return pde::chan_vese(image, domain, {.mu = 0.6}, alone).above.voxels; });
  expect_same_bits([&] { return pde::continuous_min_cut(weight, state, {.max_iterations = 40}, alone).u.voxels; });
}

}  // namespace
}  // namespace heartgen::pde
