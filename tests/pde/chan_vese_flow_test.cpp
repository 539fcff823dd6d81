// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/chan_vese_flow.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "generator/pde/row_loops.hpp"
#include "model/error.hpp"
#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::at_threads;
using testing::ball;
using testing::grid_of;
using testing::length;
using testing::noisy;
using testing::slab_of;
using testing::volume_of;
const auto alone = parallel::self();

/// One sweep voxel by voxel as the formula reads, in double.
struct SlowSweep {
  const Volume<float>& image;
  const Mask& domain;
  double c_below, c_above;
  pde::ChanVeseFlowSettings settings;
  Vec3 w;  ///< smallest spacing / spacing
  double h;

  bool in(const Index3& p) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (p[a] < 0 || p[a] >= image.grid.size[a]) return false;
    return domain(p[0], p[1], p[2]) != 0;
  }
  static Index3 next_to(Index3 p, std::size_t axis, int step) {
    p[axis] += step;
    return p;
  }
  double at(const Volume<float>& u, const Index3& p, const Index3& otherwise) const {
    const Index3& q = in(p) ? p : otherwise;
    return u(q[0], q[1], q[2]);
  }
  double central(const Volume<float>& u, const Index3& p, std::size_t axis) const {
    return w[static_cast<int>(axis)] * (at(u, next_to(p, axis, 1), p) - at(u, next_to(p, axis, -1), p)) / 2;
  }
  /// Coefficient of the face between p and its upper neighbour.
  double face(const Volume<float>& u, const Index3& p, std::size_t axis) const {
    const auto upper = next_to(p, axis, 1);
    if (!in(p) || !in(upper)) return 0;
    const double weight = w[static_cast<int>(axis)];
    double square = std::pow(weight * (at(u, upper, p) - at(u, p, p)), 2);
    for (std::size_t other = 0; other < 3; ++other)
      if (other != axis) square += std::pow(central(u, p, other), 2);
    return settings.mu / h * weight * weight / std::sqrt(std::max(square, 1e-30));
  }
  double operator()(const Volume<float>& u, const Index3& p) const {
    const double here = at(u, p, p);
    if (!in(p)) return u(p[0], p[1], p[2]);
    double neighbours = 0, weights = 0, slope = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto lower = next_to(p, axis, -1), upper = next_to(p, axis, 1);
      const double a = face(u, lower, axis), b = face(u, p, axis);
      neighbours += a * at(u, lower, p) + b * at(u, upper, p);
      weights += a + b;
      slope += std::pow(central(u, p, axis), 2);
    }
    const double contrast = c_above - c_below, g = image(p[0], p[1], p[2]);
    const double pull = settings.norm == pde::Norm::l1
                            ? (std::abs(g - c_below) - std::abs(g - c_above)) / contrast
                            : ((g - c_below) * (g - c_below) - (g - c_above) * (g - c_above)) / (contrast * contrast);
    const double speed = settings.time_step * std::sqrt(slope);
    return (here + speed * (neighbours + settings.lambda * pull)) / (1 + speed * weights);
  }
};

Mask part_of(const Grid& grid) {
  return volume_of<std::uint8_t>(grid, [](double x, double y, double z) {
    return std::sin(2.1 * x) + std::cos(1.7 * y) + std::sin(1.3 * z + 1) > -0.6 ? 1 : 0;
  });
}

TEST(ChanVeseFlow, SweepsAsTheFormulaReads) {
  for (const Index3 size : {Index3{19, 13, 7}, Index3{37, 9, 1}, Index3{5, 1, 4}})
    for (const pde::Norm norm : {pde::Norm::l1, pde::Norm::l2})
      for (const bool masked : {false, true}) {
        const Grid grid = grid_of(size, {0.7, 0.9, 1.3});
        const auto image = noisy(ball(grid, 3), 0.4);
        const auto domain = masked ? part_of(grid) : Mask(grid, 1);
        auto phi = noisy(Volume<float>(grid, 0.1f), 0.8);
        pde::ChanVeseFlowSettings settings;
        settings.norm = norm;
        settings.mu = 0.4;
        settings.time_step = 0.3;
        settings.lambda = 1.7;
        auto slab = slab_of(phi);
        pde::sweep_flow(slab_of(image), slab_of(domain), slab, 0.1, 0.9, settings, 1, alone);
        const auto fast = parallel::gather(slab, alone);
        const double h = 0.7;
        const Vec3 w{h / 0.7, h / 0.9, h / 1.3};
        const SlowSweep slow{image, domain, 0.1, 0.9, settings, w, h};
        for (std::int64_t k = 0; k < size[2]; ++k)
          for (std::int64_t j = 0; j < size[1]; ++j)
            for (std::int64_t i = 0; i < size[0]; ++i)
              ASSERT_NEAR(fast(i, j, k), slow(phi, {i, j, k}), 2e-4) << i << " " << j << " " << k << " " << masked;
      }
}

TEST(ChanVeseFlow, HasTheSameBitsForAnyVectorLengthAndNumberOfThreads) {
  for (const Index3 size : {Index3{75, 41, 6}, Index3{70, 45, 1}, Index3{3, 2, 5}})
    for (const bool masked : {false, true}) {
      const Grid grid = grid_of(size, {0.8, 0.8, 1.5});
      const auto image = slab_of(noisy(ball(grid, 5), 0.5));
      const auto domain = slab_of(masked ? part_of(grid) : Mask(grid, 1));
      const auto run = [&] {
        auto phi = slab_of(noisy(Volume<float>(grid, 0), 1));
        pde::sweep_flow(image, domain, phi, 0, 1, {.mu = 0.3}, 5, alone);
        return phi.values;
      };
      parallel::set_simd_level(parallel::Simd::plain);
      const auto plain = run();
      for (const parallel::Simd level : {parallel::Simd::avx2, parallel::Simd::avx512}) {
        parallel::set_simd_level(level);
        for (const auto& result : at_threads(run)) ASSERT_EQ(result, plain) << name_of(parallel::simd_level());
      }
    }
}

/// dr/dt = -2 mu / r for a sphere, where the image says nothing; small steps, because the scheme is slow at large ones.
TEST(ChanVeseFlow, SpheresShrinkByTheirCurvature) {
  const Grid grid = grid_of({41, 41, 41});
  auto phi = slab_of(volume_of(grid, [](double x, double y, double z) { return 14 - length(x, y, z); }));
  const Volume<float> image(grid, 0.5f);
  const pde::ChanVeseFlowSettings settings{.mu = 1, .time_step = 0.01};
  pde::sweep_flow(slab_of(image), slab_of(Mask(grid, 1)), phi, 0, 1, settings, 1500, alone);
  const auto now = parallel::gather(phi, alone);
  double radius = 0;  // where φ changes sign on the way from the centre
  for (std::int64_t i = 20; i < 40; ++i) {
    const double a = now(i, 20, 20), b = now(i + 1, 20, 20);
    if (a > 0 && b <= 0) radius = static_cast<double>(i) - 20 + a / (a - b);
  }
  EXPECT_NEAR(radius, std::sqrt(14 * 14 - 4 * 15.0), 0.25);
}

TEST(ChanVeseFlow, SegmentsWhatTheConvexFormSegments) {
  const Grid grid = grid_of({64, 48, 1});
  const auto clean = volume_of(
      grid, [](double x, double y, double) { return length(x + 14, y) < 9 || length(x - 12, y + 3) < 7 ? 200 : -100; });
  const auto image = slab_of(noisy(clean, 90));
  const auto domain = slab_of(Mask(grid, 1));
  for (const pde::Norm norm : {pde::Norm::l1, pde::Norm::l2}) {
    const auto found = pde::chan_vese_flow(image, domain, {.norm = norm, .mu = 1}, alone);
    int wrong = 0;
    for (std::size_t i = 0; i < clean.voxels.size(); ++i) wrong += (clean.voxels[i] > 0) != found.above.owned()[i];
    EXPECT_LT(wrong, 60);
    EXPECT_NEAR(found.c_below, -100, 15);
    EXPECT_NEAR(found.c_above, 200, 25);
    EXPECT_GT(found.iterations, 0);
    EXPECT_DOUBLE_EQ(found.energy, pde::chan_vese_energy(image, domain, found.above, found.c_below, found.c_above,
                                                         {.norm = norm, .mu = 1}, alone));
  }
}

TEST(ChanVeseFlow, RefusesBadInput) {
  const Grid grid = grid_of({6, 5, 4});
  const auto image = slab_of(Volume<float>(grid, 1));
  EXPECT_THROW(pde::chan_vese_flow(image, slab_of(Mask(grid, 0)), {}, alone), UserError);
  EXPECT_THROW(pde::chan_vese_flow(image, slab_of(Mask(grid, 1)), {.time_step = 0}, alone), UserError);
  EXPECT_THROW(pde::chan_vese_flow(image, slab_of(Mask(grid, 1)), {.lambda = -1}, alone), UserError);
}

}  // namespace
}  // namespace heartgen::pde
