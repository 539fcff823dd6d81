// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/safe_screening.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::at_threads;
using testing::grid_of;
using testing::slab_of;
const auto alone = parallel::self();

/// Minimises TV(u) - <s, u> over 0 <= u <= 1 on the domain by many plain primal-dual steps in double.
struct SlowMinimum {
  const Mask& domain;
  std::vector<double> s, u, bar, p[3];
  double w[3];

  SlowMinimum(const Mask& d, std::vector<double> force, const pde::AxisWeights& weights)
      : domain(d), s(std::move(force)), u(s.size(), 0.5), bar(u), w{weights.x, weights.y, weights.z} {
    for (auto& component : p) component.assign(s.size(), 0);
  }

  /// Offset of the upper neighbour along an axis, or -1 where there is no link.
  std::int64_t upper(const Index3& v, std::size_t axis) const {
    Index3 n = v;
    if (++n[axis] >= domain.grid.size[axis] || !domain(v[0], v[1], v[2]) || !domain(n[0], n[1], n[2])) return -1;
    return domain.grid.offset(n[0], n[1], n[2]);
  }

  template <class Body>
  void for_voxels(Body&& body) {
    for (std::int64_t k = 0; k < domain.grid.size[2]; ++k)
      for (std::int64_t j = 0; j < domain.grid.size[1]; ++j)
        for (std::int64_t i = 0; i < domain.grid.size[0]; ++i)
          body(Index3{i, j, k}, static_cast<std::size_t>(domain.grid.offset(i, j, k)));
  }

  void step() {
    constexpr double sigma = 0.28;
    std::vector<double> divergence(u.size(), 0);
    for_voxels([&](const Index3& v, std::size_t here) {
      double norm = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto n = upper(v, a);
        if (n >= 0) p[a][here] += sigma * w[a] * (bar[static_cast<std::size_t>(n)] - bar[here]);
        norm += p[a][here] * p[a][here];
      }
      for (auto& component : p) component[here] /= std::max(1.0, std::sqrt(norm));
      for (std::size_t a = 0; a < 3; ++a) {
        const auto n = upper(v, a);
        if (n < 0) continue;
        divergence[here] += w[a] * p[a][here];
        divergence[static_cast<std::size_t>(n)] -= w[a] * p[a][here];
      }
    });
    for (std::size_t i = 0; i < u.size(); ++i) {
      const double next = std::clamp(u[i] + sigma * (divergence[i] + s[i]), 0.0, 1.0);
      bar[i] = 2 * next - u[i];
      u[i] = next;
    }
  }
};

TEST(Decided, AgreesWithEveryMinimiser) {
  std::mt19937 random(5);
  const auto uniform = [&] { return 2 * static_cast<double>(random()) / 4294967295.0 - 1; };
  std::int64_t decided = 0, by_pull_alone = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const Grid grid = grid_of(trial % 3 ? Index3{7, 6, 5} : Index3{14, 12, 1});
    const pde::AxisWeights weights{1, 1, grid.size[2] > 1 ? 0.6f : 0.0f};
    Volume<float> image(grid);
    Mask domain(grid, 1);
    for (auto& g : image.voxels) g = static_cast<float>(uniform() + (random() % 3 ? 0.8 : -0.8));
    for (auto& d : domain.voxels) d = random() % 8 != 0;
    const pde::LinearForce force{3, 0.1f, 7};
    const auto state = pde::screen(slab_of(image), slab_of(domain), force, weights, alone);
    std::vector<double> pull;
    for (const float g : image.voxels) pull.push_back(std::clamp(force.gain * (g - force.middle), -7.0f, 7.0f));
    SlowMinimum slow(domain, pull, weights);
    for (int step = 0; step < 3000; ++step) slow.step();
    for (std::size_t i = 0; i < pull.size(); ++i) {
      const auto found = state.owned()[i];
      EXPECT_EQ(found == decided_outside, domain.voxels[i] == 0);
      if (found == decided_above) {
        EXPECT_GT(slow.u[i], 0.98) << trial << " " << i;
      }
      if (found == decided_below) {
        EXPECT_LT(slow.u[i], 0.02) << trial << " " << i;
      }
      decided += found == decided_above || found == decided_below;
      by_pull_alone += found != decided_outside && std::abs(pull[i]) > 4.2;
    }
  }
  EXPECT_GT(decided, by_pull_alone);  // neighbours decide voxels that are too weak alone
}

TEST(Decided, IsTheSameForAnyNumberOfThreads) {
  const Grid grid = grid_of({31, 23, 9});
  const auto image = slab_of(testing::noisy(testing::ball(grid, 7), 0.4));
  const auto domain = slab_of(Mask(grid, 1));
  const auto results = at_threads([&] { return pde::screen(image, domain, {6, 0.5f, 4}, {1, 1, 1}, alone).values; });
  for (const auto& result : results) EXPECT_EQ(result, results[0]);
}

}  // namespace
}  // namespace heartgen::pde
