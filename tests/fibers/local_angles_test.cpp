// Carrying axes as angles in the wall: what the regression keeps and what it distrusts.
#include "generator/fibers/local_angles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "support/model_heart.hpp"

namespace heart {
namespace {

using testing::axis_angle_deg;

constexpr double degree = std::numbers::pi / 180;

/// Samples of a slab of wall, 2 mm apart along it and 0.025 in depth.
fibers::AngleSamples slab(const std::function<Vec3(int number, double depth)>& local_axis) {
  fibers::AngleSamples samples;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j)
      for (int k = 0; k <= 40; ++k) {
        const double depth = 0.025 * k;
        const auto number = static_cast<int>(samples.tensor.size());
        samples.feature.push_back(fibers::place_feature({2.0 * i, 2.0 * j, 10 * depth}, depth));
        samples.tensor.push_back(atlas::axis_tensor(local_axis(number, depth)));
      }
  return samples;
}

Vec3 carried_at(const fibers::AngleSamples& samples, const Vec3& place_mm, double depth) {
  fibers::AngleQuery query;
  query.feature = fibers::place_feature(place_mm, depth);
  query.at.circumferential = {1, 0, 0};
  query.at.longitudinal = {0, 1, 0};
  query.at.normal = {0, 0, 1};
  return atlas::leading_axis(fibers::carry_local_angles(samples, {query}).front());
}

TEST(LocalAngles, AHelixThatTurnsWithDepthIsFoundBetweenTheSamples) {
  const auto helix = [](double depth) {
    const double angle = 60 * (1 - 2 * depth) * degree;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  };
  const auto samples = slab([&](int, double depth) { return helix(depth); });
  for (const double depth : {0.33, 0.5, 0.71})
    EXPECT_LT(axis_angle_deg(carried_at(samples, {0.7, -1.1, 10 * depth}, depth), helix(depth)), 1) << depth;
}

TEST(LocalAngles, SamplesWhoseFiberLeavesTheirWallHardlyCount) {
  const Vec3 along{1, 0, 0}, off{std::cos(40 * degree), 0, std::sin(40 * degree)};
  const auto samples = slab([&](int number, double) { return number % 3 == 0 ? off : along; });
  EXPECT_LT(axis_angle_deg(carried_at(samples, {0.7, -1.1, 5}, 0.5), along), 3);
}

}  // namespace
}  // namespace heart
