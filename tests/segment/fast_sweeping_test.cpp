#include "generator/segment/fast_sweeping.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "segment/pde_images.hpp"

namespace heart::segment {
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
  const auto found = fast_sweeping(volume_of(grid, function));
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
  const auto found = fast_sweeping(volume_of(grid, [&](double x, double y, double z) { return 3.7 * plane(x, y, z); }));
  for (std::size_t i = 0; i < exact.voxels.size(); ++i)
    if (seen.voxels[i]) {
      EXPECT_NEAR(found.voxels[i], exact.voxels[i], 0.005) << i;
    }
}

TEST(FastSweeping, MasksHaveTheirBorderHalfWayBetweenVoxels) {
  const auto mask =
      volume_of(grid_of({20, 7, 5}, {0.5, 0.5, 1}), [](double x, double, double) { return x < 1 ? -1 : 1; });
  const auto found = fast_sweeping(mask);
  for (std::int64_t i = 0; i < 20; ++i) EXPECT_NEAR(found(i, 3, 2), 0.5 * (static_cast<double>(i) - 11.5), 1e-4) << i;
}

TEST(FastSweeping, LeavesWhatHasNoZeroLevel) {
  const Volume<float> one(grid_of({5, 4, 3}), 1);
  EXPECT_EQ(fast_sweeping(one).voxels, one.voxels);
}

/// Waves run outwards: what is nearer than the bound does not know of it.
TEST(FastSweeping, ABoundLeavesWhatIsNearerAndHoldsTheRest) {
  const auto ball = volume_of(cube(40, false), [](double x, double y, double z) { return length(x, y, z) - 7; });
  constexpr float within = 4;
  const auto all = fast_sweeping(ball), near = fast_sweeping(ball, within);
  std::size_t bounded = 0;
  for (std::size_t i = 0; i < all.voxels.size(); ++i) {
    EXPECT_NEAR(near.voxels[i], std::clamp(all.voxels[i], -within, within), 1e-5) << i;
    bounded += std::abs(near.voxels[i]) == within;
  }
  EXPECT_GT(bounded, all.voxels.size() / 4);
}

TEST(FastSweeping, HasTheSameBitsForAnyNumberOfThreads) {
  const auto image = testing::noisy(
      testing::volume_of(grid_of({25, 21, 17}), [](double x, double y, double z) { return length(x, y, z) - 6; }), 0.4);
  const auto results = at_threads([&] { return fast_sweeping(image).voxels; });
  for (const auto& result : results) EXPECT_EQ(result, results[0]);
}

}  // namespace
}  // namespace heart::segment
