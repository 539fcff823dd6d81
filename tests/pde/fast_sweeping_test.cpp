// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/fast_sweeping.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "pde/pde_images.hpp"

namespace heartgen::pde {
namespace {

using testing::at_threads;
using testing::grid_of;
using testing::length;
using testing::volume_of;

/// Largest errors in voxels.
struct Errors {
  double beside = 0;   ///< within 0.8 voxels of the zero level
  double outside = 0;  ///< up to 6 mm outside
  double inside = 0;   ///< inside, where the function counts
};

/// A grid of `n` voxels over 32 mm along each axis of the first two (and the third).
Grid cube(std::int64_t n, bool flat) {
  const double h = 32.0 / static_cast<double>(n);
  return grid_of({n, n, flat ? 1 : n}, {h, h, h});
}

/// Errors of the distance made from function(x, y, z) where `counts`.
template <class Function, class Exact, class Counts>
Errors errors_of(const Grid& grid, Function&& function, Exact&& exact, Counts&& counts) {
  const auto found = pde::fast_sweeping(volume_of(grid, function));
  const auto known = volume_of<double>(grid, exact);
  const auto use = volume_of<std::uint8_t>(grid, [&](double x, double y, double z) { return counts(x, y, z) ? 1 : 0; });
  Errors worst;
  const double h = grid.spacing_mm.x;
  for (std::size_t i = 0; i < known.voxels.size(); ++i) {
    const double distance = known.voxels[i], error = std::abs(found.voxels[i] - distance) / h;
    if (std::abs(distance) < 0.8 * h) worst.beside = std::max(worst.beside, error);
    if (distance > 0 && distance < 6) worst.outside = std::max(worst.outside, error);
    if (distance < 0 && use.voxels[i]) worst.inside = std::max(worst.inside, error);
  }
  return worst;
}

/// A ball of radius 8 mm by a function that is no distance; inside, distances count up to 3 mm from the centre.
Errors ball_errors(std::int64_t n, bool flat) {
  return errors_of(
      cube(n, flat),
      [](double x, double y, double z) { return (0.2 + 0.01 * (x + 16)) * (x * x + y * y + z * z - 64); },
      [](double x, double y, double z) { return length(x, y, z) - 8; },
      [&](double x, double y, double z) { return length(x, y, z) > 3; });
}

/// The errors that the header states, for a radius of eight voxels.
TEST(FastSweeping, BallsAreExactToAFractionOfAVoxel) {
  for (const bool flat : {false, true}) {
    const Errors e = ball_errors(32, flat);
    EXPECT_LT(e.beside, 0.01) << flat;
    EXPECT_LT(e.outside, 0.04) << flat;
    EXPECT_LT(e.inside, 0.1) << flat;
  }
}

/// Errors in mm fall at least as the square of the voxel: in voxels by two where it halves (with some room).
TEST(FastSweeping, ConvergesWithTheSquareOfTheVoxel) {
  const Errors coarse = ball_errors(24, false), fine = ball_errors(48, false);
  EXPECT_LT(fine.beside, coarse.beside / 1.8);
  EXPECT_LT(fine.outside, coarse.outside / 1.8);
}

/// Distance from (x, y) to an ellipse with half axes a, b, by bisection on the Lagrange multiplier.
double ellipse_distance(double x, double y, double a, double b) {
  x = std::abs(x);
  y = std::abs(y);
  const auto excess = [&](double t) { return std::pow(a * x / (t + a * a), 2) + std::pow(b * y / (t + b * b), 2) - 1; };
  double low = -b * b + b * y * 0.999999, high = 1e4;
  for (int n = 0; n < 200; ++n) {
    const double middle = (low + high) / 2;
    (excess(middle) > 0 ? low : high) = middle;
  }
  const double px = a * a * x / (low + a * a), py = b * b * y / (low + b * b);
  const bool in = x * x / (a * a) + y * y / (b * b) < 1;
  return (in ? -1 : 1) * length(x - px, y - py);
}

TEST(FastSweeping, EllipsesAreExactToAFractionOfAVoxel) {
  constexpr double a = 12, b = 10;  // smallest radius of curvature: 8.3
  const Errors e = errors_of(
      cube(32, true), [](double x, double y, double) { return x * x / (a * a) + y * y / (b * b) - 1; },
      [](double x, double y, double) { return ellipse_distance(x + 1e-9, y + 1e-9, a, b); },
      [](double x, double y, double) { return length(x / 7, y / 4) > 1; });
  EXPECT_LT(e.beside, 0.01);
  EXPECT_LT(e.outside, 0.04);
  EXPECT_LT(e.inside, 0.1);
}

/// Where the closest point of the plane lies well in the image; elsewhere what it depends on is not all there.
TEST(FastSweeping, PlanesAreExactToAHundredthOfAVoxelOnAnySpacing) {
  const double norm = length(0.6, -0.3, 1);
  const Vec3 n{0.6 / norm, -0.3 / norm, 1 / norm};
  const Grid grid = grid_of({20, 16, 12}, {0.5, 0.7, 1.2});
  const auto plane = [&](double x, double y, double z) { return n.x * x + n.y * y + n.z * z - 0.37; };
  const auto exact = volume_of<double>(grid, plane);
  const auto seen = volume_of<std::uint8_t>(grid, [&](double x, double y, double z) {
    const double d = plane(x, y, z);
    return std::abs(d) < 3 && std::abs(x - d * n.x) < 3.5 && std::abs(y - d * n.y) < 3.5 && std::abs(z - d * n.z) < 3.5
               ? 1
               : 0;
  });
  const auto found =
      pde::fast_sweeping(volume_of(grid, [&](double x, double y, double z) { return 3.7 * plane(x, y, z); }));
  for (std::size_t i = 0; i < exact.voxels.size(); ++i)
    if (seen.voxels[i]) {
      EXPECT_NEAR(found.voxels[i], exact.voxels[i], 0.005) << i;
    }
}

TEST(FastSweeping, MasksHaveTheirBorderHalfWayBetweenVoxels) {
  const auto mask =
      volume_of(grid_of({20, 7, 5}, {0.5, 0.5, 1}), [](double x, double, double) { return x < 1 ? -1 : 1; });
  const auto found = pde::fast_sweeping(mask);
  for (std::int64_t i = 0; i < 20; ++i) EXPECT_NEAR(found(i, 3, 2), 0.5 * (static_cast<double>(i) - 11.5), 1e-4) << i;
}

TEST(FastSweeping, LeavesWhatHasNoZeroLevel) {
  const Volume<float> one(grid_of({5, 4, 3}), 1);
  EXPECT_EQ(pde::fast_sweeping(one).voxels, one.voxels);
}

/// Waves run outwards: what is nearer than the bound does not know of it.
TEST(FastSweeping, ABoundLeavesWhatIsNearerAndHoldsTheRest) {
  const auto ball = volume_of(cube(40, false), [](double x, double y, double z) { return length(x, y, z) - 7; });
  constexpr float within = 4;
  const auto all = pde::fast_sweeping(ball), near = pde::fast_sweeping(ball, within);
  std::size_t bounded = 0;
  for (std::size_t i = 0; i < all.voxels.size(); ++i) {
    EXPECT_NEAR(near.voxels[i], std::clamp(all.voxels[i], -within, within), 1e-5) << i;
    bounded += std::abs(near.voxels[i]) == within;
  }
  EXPECT_GT(bounded, all.voxels.size() / 4);
}

/// The sweeps as they are in books: every voxel each time, beginning at the distances beside the zero level.
struct PlainSweeps {
  Volume<float> distance;
  std::vector<bool> kept;
  float within_mm;

  double seen(const Index3& at, std::size_t axis, std::int64_t steps, double sign) const {
    Index3 to = at;
    to[axis] += steps;
    const bool exists = to[axis] >= 0 && to[axis] < distance.grid.size[axis];
    return exists ? sign * distance(to[0], to[1], to[2]) : double{pde::any_distance_mm};
  }

  void visit(const Index3& at, bool second_order) {
    float& here = distance(at[0], at[1], at[2]);
    const double sign = here < 0 ? -1 : 1;
    std::array<std::pair<double, double>, 3> terms;
    for (std::size_t a = 0; a < 3; ++a) {
      const double h = distance.grid.spacing_mm[static_cast<int>(a)], lower = seen(at, a, -1, sign),
                   upper = seen(at, a, 1, sign), near = std::min(lower, upper);
      const double far = second_order ? seen(at, a, lower < upper ? -2 : 2, sign) : double{pde::any_distance_mm};
      terms[a] = far <= near ? std::pair{(4 * near - far) / 3, 1 / (h * h) * 9 / 4} : std::pair{near, 1 / (h * h)};
      if (near >= double{pde::any_distance_mm}) terms[a] = {near, 0};
    }
    std::ranges::stable_sort(terms, {}, &std::pair<double, double>::first);
    if (terms[0].first >= double{within_mm}) return;
    double v = 0, a = 0, b = 0, c = -1;
    for (std::size_t n = 0; n < 3 && (n == 0 || terms[n].first < v); ++n) {
      a += terms[n].second;
      b += terms[n].second * terms[n].first;
      c += terms[n].second * terms[n].first * terms[n].first;
      v = (b + std::sqrt(std::max(b * b - a * c, 0.0))) / a;
    }
    if (second_order || v < sign * here) here = static_cast<float>(sign * v);
  }

  void sweep_all_directions(bool second_order) {
    const auto& size = distance.grid.size;
    for (unsigned direction = 0; direction < 8; ++direction)
      for (std::int64_t n = 0; n < distance.grid.voxel_count(); ++n) {
        Index3 at{n % size[0], n / size[0] % size[1], n / (size[0] * size[1])};
        for (std::size_t a = 0; a < 3; ++a)
          if ((direction >> a) & 1U) at[a] = size[a] - 1 - at[a];
        if (!kept[static_cast<std::size_t>(distance.grid.offset(at[0], at[1], at[2]))]) visit(at, second_order);
      }
  }
};

/// What is left out (settled rows and voxels) changes no bit.
TEST(FastSweeping, LeavesOutNothingThatWouldChange) {
  for (const float within : {pde::any_distance_mm, 9.0F}) {
    const auto grid = grid_of({37, 22, 19}, {0.7, 1, 1.3});
    const auto image =
        testing::noisy(volume_of(grid, [](double x, double y, double z) { return length(x, y, z) - 5; }), 0.3);
    const auto found = pde::fast_sweeping(image, within);
    PlainSweeps plain{found, std::vector<bool>(image.voxels.size(), false), within};
    for (std::int64_t n = 0; n < grid.voxel_count(); ++n) {
      const Index3 at{n % 37, n / 37 % 22, n / (37 * 22)};
      const auto v = static_cast<std::size_t>(n);
      const bool inside = image.voxels[v] < 0;
      for (std::size_t a = 0; a < 3; ++a)
        for (const std::int64_t side : {-1, 1}) {
          Index3 to = at;
          to[a] += side;
          if (grid.contains(to[0], to[1], to[2]) && (image(to[0], to[1], to[2]) < 0) != inside) plain.kept[v] = true;
        }
      if (!plain.kept[v]) plain.distance.voxels[v] = inside ? -pde::any_distance_mm : pde::any_distance_mm;
    }
    for (const bool second_order : {false, false, true, true}) plain.sweep_all_directions(second_order);
    for (float& mm : plain.distance.voxels) mm = std::clamp(mm, -within, within);
    EXPECT_EQ(found.voxels, plain.distance.voxels) << within;
  }
}

TEST(FastSweeping, HasTheSameBitsForAnyNumberOfThreads) {
  const auto image = testing::noisy(
      testing::volume_of(grid_of({25, 21, 17}), [](double x, double y, double z) { return length(x, y, z) - 6; }), 0.4);
  const auto results = at_threads([&] { return pde::fast_sweeping(image).voxels; });
  for (const auto& result : results) EXPECT_EQ(result, results[0]);
}

}  // namespace
}  // namespace heartgen::pde
