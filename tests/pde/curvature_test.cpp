// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/curvature.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::grid_of;
const auto alone = parallel::self();

/// Radius where the row through the centre falls through zero.
double zero_radius(const parallel::Slab<float>& u, std::int64_t j, std::int64_t k) {
  const float* row = u.row(j, k);
  const double centre = 0.5 * static_cast<double>(u.grid.size[0] - 1);
  for (std::int64_t i = u.grid.size[0] / 2; i + 1 < u.grid.size[0]; ++i)
    if (row[i] <= 0 && row[i + 1] > 0)
      return (static_cast<double>(i) + row[i] / (row[i] - row[i + 1]) - centre) * u.grid.spacing_mm.x;
  return 0;
}

TEST(CurvatureMotion, ShrinksACircleBySquareRootLaw) {
  const auto image =
      testing::volume_of(grid_of({81, 81, 1}), [](double x, double y, double) { return testing::length(x, y) - 20; });
  auto slab = testing::slab_of(image);
  pde::curvature_motion(slab, {800, 0.1}, alone);
  EXPECT_NEAR(zero_radius(slab, 40, 0), std::sqrt(20 * 20 - 2 * 80.0), 0.3);
}

TEST(CurvatureMotion, ShrinksASphereTwiceAsFastOnAnAnisotropicGrid) {
  const auto image = testing::volume_of(grid_of({45, 45, 31}, {0.8, 0.8, 1.2}),
                                        [](double x, double y, double z) { return testing::length(x, y, z) - 12; });
  auto slab = testing::slab_of(image);
  pde::curvature_motion(slab, {200, 0.1}, alone);
  EXPECT_NEAR(zero_radius(slab, 22, 15), std::sqrt(12 * 12 - 4 * 100 * 0.2 * 0.64), 0.3);
}

TEST(CurvatureMotion, LeavesPlanesAndFlatImagesAlone) {
  const auto plane = testing::volume_of(grid_of({12, 10, 9}), [](double x, double, double z) { return 2 * x + z; });
  auto slab = testing::slab_of(plane);
  pde::curvature_motion(slab, {3, 0.1}, alone);
  EXPECT_NEAR(slab.row(5, 4)[6], plane(6, 5, 4), 1e-4);
  auto constant = testing::slab_of(Volume<float>(grid_of({5, 5, 5}), 7.0f));
  pde::curvature_motion(constant, {3, 0.1}, alone);
  for (const float v : constant.owned()) EXPECT_FLOAT_EQ(v, 7.0f);
  EXPECT_THROW(pde::curvature_motion(constant, {3, 0}, alone), UserError);
}

/// The level sets of a peak are closed curves: each vanishes once its area is used up, 2 pi of it per unit of time.
TEST(CurvatureMotion, SinksPeaksAndBarsOneVoxelWide) {
  const auto highest = [](const Volume<float>& image, int iterations) {
    auto slab = testing::slab_of(image);
    pde::curvature_motion(slab, {iterations, 0.1}, alone);
    return *std::ranges::max_element(slab.owned());
  };
  for (const Index3 size : {Index3{15, 13, 1}, Index3{15, 13, 11}}) {
    Volume<float> peak(grid_of(size), 10.0f);
    peak(7, 6, size[2] / 2) = 110;
    EXPECT_LT(highest(peak, 10), 15) << size[2];
  }
  Volume<float> bar(grid_of({31, 15, 1}), 0.0f);
  for (std::int64_t i = 10; i < 19; ++i) bar(i, 7, 0) = 100;  // its level sets: at most 9 voxels, gone after 15 steps
  EXPECT_LT(highest(testing::noisy(bar, 5), 60), 15);
}

}  // namespace
}  // namespace heartgen::pde
