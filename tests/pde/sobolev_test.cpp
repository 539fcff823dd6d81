// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/sobolev.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::grid_of;
const auto alone = parallel::self();

TEST(Sobolev, DividesCosineModesByOnePlusTheirEigenvalue) {
  const Grid grid = grid_of({16, 12, 6}, {0.5, 0.7, 1.5});
  const auto mode = [](double m, std::int64_t i, double n) {
    return std::cos(m * std::numbers::pi * (double(i) + 0.5) / n);
  };
  const auto eigenvalue = [](double m, double n, double h) {
    return (2 - 2 * std::cos(m * std::numbers::pi / n)) / (h * h);
  };
  for (const double length : {0.3, 1.0, 4.0}) {
    Volume<float> image(grid);
    for (std::int64_t k = 0; k < 6; ++k)
      for (std::int64_t j = 0; j < 12; ++j)
        for (std::int64_t i = 0; i < 16; ++i)
          image(i, j, k) = static_cast<float>(20 + mode(3, i, 16) * mode(2, j, 12) + mode(1, k, 6));
    auto slab = testing::slab_of(image);
    pde::sobolev(slab, {length, 1e-6}, alone);
    const double first = 1 / (1 + length * length * (eigenvalue(3, 16, 0.5) + eigenvalue(2, 12, 0.7)));
    const double second = 1 / (1 + length * length * eigenvalue(1, 6, 1.5));
    for (std::int64_t k = 0; k < 6; ++k)
      for (std::int64_t j = 0; j < 12; ++j)
        for (std::int64_t i = 0; i < 16; ++i)
          EXPECT_NEAR(slab.row(j, k)[i], 20 + first * mode(3, i, 16) * mode(2, j, 12) + second * mode(1, k, 6), 3e-5);
  }
}

TEST(Sobolev, LengthZeroChangesNothing) {
  const auto image = testing::noisy(testing::ball(grid_of({9, 8, 7}), 3), 1);
  auto slab = testing::slab_of(image);
  pde::sobolev(slab, {0, 1e-4}, alone);
  EXPECT_EQ(parallel::gather(slab, alone).voxels, image.voxels);
  EXPECT_THROW(pde::sobolev(slab, {-1, 1e-4}, alone), UserError);
  EXPECT_THROW(pde::sobolev(slab, {1, 0}, alone), UserError);
}

}  // namespace
}  // namespace heartgen::pde
