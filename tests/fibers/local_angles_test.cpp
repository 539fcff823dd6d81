// SPDX-License-Identifier: GPL-3.0-or-later
// Carrying axes as angles in the wall: what the regression keeps and what it distrusts.
#include "generator/fibers/local_angles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "support/model_heart.hpp"

namespace heartgen {
namespace {

using testing::axis_angle_deg;

constexpr double degree = std::numbers::pi / 180;

const Vec3 outwards{0, 0, 1};

double nowhere(double) { return 0; }

/// Samples of a slab of wall, 2 mm apart along it and 0.025 in depth, that bends by `bend_at` (x in mm).
fibers::AngleSamples slab(const std::function<Vec3(int number, double depth)>& local_axis,
                          const std::function<double(double x_mm)>& bend_at = nowhere) {
  fibers::AngleSamples samples;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j)
      for (int k = 0; k <= 40; ++k) {
        const double depth = 0.025 * k;
        const auto number = static_cast<int>(samples.tensor.size());
        samples.feature.push_back(
            fibers::place_feature({2.0 * i, 2.0 * j, 10 * depth}, depth, bend_at(2.0 * i), outwards));
        samples.tensor.push_back(axis_tensor(local_axis(number, depth)));
      }
  return samples;
}

Vec3 carried_at(const fibers::AngleSamples& samples, const Vec3& place_mm, double depth, double bend = 0,
                const Vec3& normal = outwards) {
  const auto feature = fibers::place_feature(place_mm, depth, bend, normal);
  return leading_axis(fibers::fit_local_angles(samples, {feature}).front().tensor);
}

TEST(LocalAngles, AHelixThatTurnsWithDepthIsFoundBetweenTheSamples) {
  const auto helix = [](double depth) {
    const double angle = 60 * (1 - 2 * depth) * degree;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  };
  const auto samples = slab([&](int, double depth) { return helix(depth); });
  for (const double depth : {0.33, 0.5, 0.71})
    EXPECT_LT(axis_angle_deg(carried_at(samples, {0.7, -1.1, 10 * depth}, depth, 0), helix(depth)), 1) << depth;
}

TEST(LocalAngles, SamplesWhoseFiberLeavesTheirWallHardlyCount) {
  const Vec3 along{1, 0, 0}, off{std::cos(40 * degree), 0, std::sin(40 * degree)};
  const auto samples = slab([&](int number, double) { return number % 3 == 0 ? off : along; });
  EXPECT_LT(axis_angle_deg(carried_at(samples, {0.7, -1.1, 5}, 0.5), along), 3);
}

TEST(LocalAngles, SamplesThatMostAroundThemContradictHardlyCount) {
  const Vec3 along{1, 0, 0}, across{std::cos(60 * degree), std::sin(60 * degree), 0};
  const auto samples = slab([&](int number, double) { return number % 7 == 0 ? across : along; });
  EXPECT_LT(axis_angle_deg(carried_at(samples, {0.7, -1.1, 5}, 0.5), along), 1);  // 4.5 where all count
}

TEST(LocalAngles, AnglesThatChangeWithTheWallsNormalAreFollowedBeyondTheSamples) {
  const auto tilted = [](double tilt_deg) { return Vec3{0, std::sin(tilt_deg * degree), std::cos(tilt_deg * degree)}; };
  const auto helix = [](double tilt_deg) {
    return Vec3{std::cos(2 * tilt_deg * degree), std::sin(2 * tilt_deg * degree), 0};
  };
  const auto tilt_of = [](int number) { return static_cast<double>(number % 5 - 2); };
  auto samples = slab([&](int number, double) { return helix(tilt_of(number)); });
  for (std::size_t n = 0; n < samples.feature.size(); ++n) {
    const Vec3 place = fibers::place_of(samples.feature[n]);
    samples.feature[n] = fibers::place_feature(place, place.z / 10, 0, tilted(tilt_of(static_cast<int>(n))));
  }
  // 5.4 where normals only choose the samples.
  EXPECT_LT(axis_angle_deg(carried_at(samples, {0.7, -1.1, 5}, 0.5, 0, tilted(3)), helix(3)), 3.5);
}

TEST(LocalAngles, WhatWasMeasuredInABendOfTheWallTellsOfBends) {
  constexpr double bent = 0.35, half_width_mm = 3;
  const Vec3 straight{1, 0, 0}, off{std::cos(15 * degree), std::sin(15 * degree), 0};
  const auto bend_at = [&](double x_mm) { return std::abs(x_mm) < half_width_mm ? bent : 0.0; };
  fibers::AngleSamples samples = slab([&](int, double) { return straight; }, bend_at);
  for (std::size_t n = 0; n < samples.feature.size(); ++n)
    if (std::abs(fibers::place_of(samples.feature[n]).x) < half_width_mm) samples.tensor[n] = axis_tensor(off);
  EXPECT_LT(axis_angle_deg(carried_at(samples, {0.3, 0.7, 5}, 0.5), straight), 3);
  EXPECT_LT(axis_angle_deg(carried_at(samples, {0.3, 0.7, 5}, 0.5, bent), off), 3);
}

/// A wall that turns by 60 degrees over 5 mm, and its fibres with it.
Vec3 facing_at(double x_mm) {
  const double angle = std::clamp(x_mm + 2.5, 0.0, 5.0) * 12 * degree;
  return {std::sin(angle), 0, std::cos(angle)};
}

fibers::AngleSamples fold(const Vec3& before, const Vec3& behind) {
  auto samples = slab([&](int, double) { return before; });
  for (auto n = std::size_t{0}; n < samples.feature.size(); ++n) {
    const Vec3 place = fibers::place_of(samples.feature[n]);
    const double depth = place.z / 10;
    samples.feature[n] = fibers::place_feature(place, depth, 0, facing_at(place.x));
    if (place.x > 0) samples.tensor[n] = axis_tensor(behind);
  }
  return samples;
}

TEST(LocalAngles, BesideAFoldTheSideThatFacesTheSameWayIsLookedUp) {
  const Vec3 before{1, 0, 0}, behind{std::cos(40 * degree), std::sin(40 * degree), 0};
  auto samples = fold(before, behind);
  const double off_mm = 1.5;  // of the place, as a registration leaves it
  EXPECT_LT(axis_angle_deg(carried_at(samples, {off_mm, 0.7, 5}, 0.5, 0, facing_at(-3)), before), 5);
  EXPECT_LT(axis_angle_deg(carried_at(samples, {-off_mm, 0.7, 5}, 0.5, 0, facing_at(3)), behind), 5);
  fibers::weigh_shape({1, 0}, samples);
  EXPECT_GT(axis_angle_deg(carried_at(samples, {off_mm, 0.7, 5}, 0.5, 0, {}), before), 20);
}

TEST(LocalAngles, HowFarShapesDifferIsTheMedianAtTheSamePlaces) {
  const auto samples = slab([](int, double) { return Vec3{1, 0, 0}; }, [](double) { return 0.2; });
  std::vector<fibers::WallFeature> places;
  for (const double turn_deg : {0.0, 10.0, 20.0, 30.0, 90.0}) {
    const Vec3 normal{0, std::sin(turn_deg * degree), std::cos(turn_deg * degree)};
    places.push_back(fibers::place_feature({turn_deg / 15, 1, 5}, 0.5, turn_deg / 100, normal));
  }
  const auto difference = fibers::shape_difference(samples, places);
  EXPECT_NEAR(difference.facing, 2 * std::sin(10 * degree), 1e-9);
  EXPECT_NEAR(difference.bend, 0.1, 1e-9);
}

TEST(LocalAngles, ShapesCountLessWhereTheyDifferByMoreThanTheyCountIn) {
  const auto alike = fibers::shares_of({0.01, 0.01}), unlike = fibers::shares_of({0.2, 0.01}),
             more_so = fibers::shares_of({0.4, 0.8});
  EXPECT_EQ(alike.bend, 1);
  EXPECT_EQ(alike.facing, 1);
  EXPECT_LT(unlike.bend, 0.5);
  EXPECT_EQ(unlike.facing, 1);
  EXPECT_NEAR(more_so.bend, unlike.bend / 2, 1e-12);
  EXPECT_LT(more_so.facing, 0.2);
}

/// Places in no order, on the samples (so that many are equally far), between them and beyond them.
std::vector<fibers::WallFeature> scattered_places() {
  std::vector<fibers::WallFeature> places;
  for (int n = 0; n < 300; ++n) {
    const double depth = 0.025 * (n * 7 % 41);
    const double off_mm = n % 3 == 0 ? 0 : 0.37 * (n % 5);
    const double reach_mm = n % 17 == 0 ? 9 : 2;
    places.push_back(fibers::place_feature({reach_mm * (n * 5 % 11 - 5) + off_mm, 2.0 * (n * 3 % 11 - 5), 10 * depth},
                                           depth, 0, outwards));
  }
  return places;
}

TEST(LocalAngles, AQueryDoesNotDependOnThoseBeforeIt) {
  const auto samples = slab([](int number, double depth) {
    const double angle = (60 * (1 - 2 * depth) + 5 * std::sin(number)) * degree;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  });
  const auto places = scattered_places();
  const auto together = fibers::fit_local_angles(samples, places);
  for (std::size_t p = 0; p < places.size(); ++p)
    EXPECT_EQ(together[p].tensor.c, fibers::fit_local_angles(samples, {places[p]}).front().tensor.c) << p;
}

/// Degrees that an axis between fits at depths a and b is off `helix` at `depth`, and that the fits' plain mean is.
std::pair<double, double> off_between(const std::function<Vec3(double depth)>& helix, double a, double b,
                                      double depth) {
  const auto samples = slab([&](int, double at) { return helix(at); });
  const auto place = [](double at) { return fibers::place_feature({0, 0, 10 * at}, at, 0, outwards); };
  const auto fits = fibers::fit_local_angles(samples, {place(a), place(b)});
  auto mean = fits[0].tensor;
  mean += fits[1].tensor;
  const auto between = fibers::between_fits({&fits[0], &fits[1]}, place(depth));
  return {axis_angle_deg(leading_axis(between), helix(depth)), axis_angle_deg(leading_axis(mean), helix(depth))};
}

TEST(LocalAngles, BetweenFitsAxesTurnAsTheSlopesSay) {
  // 100 degrees over a wall, most of it outside: between 0.3 and 0.7, the mean of both ends is 4 degrees off.
  const auto helix = [](double depth) {
    const double angle = (50 - 100 * depth * depth) * degree;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  };
  const auto [between_deg, mean_deg] = off_between(helix, 0.3, 0.7, 0.5);
  EXPECT_GT(mean_deg, 3.5);
  EXPECT_LT(between_deg, mean_deg / 3);
  const auto [nearer_deg, plain_deg] = off_between(helix, 0.3, 0.7, 0.4);  // nearer to the one
  EXPECT_LT(nearer_deg, plain_deg / 2);
}

TEST(LocalAngles, BetweenFitsOfAnEvenHelixIsThatHelixWhateverTheirOrder) {
  const auto helix = [](double depth) {
    const double angle = 60 * (1 - 2 * depth) * degree;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  };
  for (const double half : {0.05, 0.1, 0.2}) {
    const double off_middle = 0.5 + half / 2;  // where the plain mean is 3, 6 and 12 degrees off
    for (const double sign : {-1, 1}) {
      const auto [between_deg, mean_deg] = off_between(helix, 0.5 - sign * half, 0.5 + sign * half, off_middle);
      EXPECT_GT(mean_deg, 50 * half) << half;
      EXPECT_LT(between_deg, mean_deg / 2) << half;
    }
  }
}

TEST(LocalAngles, FewSamplesAreAllUsed) {
  const auto all = slab([](int, double) { return Vec3{1, 0, 0}; });
  const fibers::AngleSamples few{{all.feature.begin(), all.feature.begin() + 5},
                                 {all.tensor.begin(), all.tensor.begin() + 5}};
  for (const auto& fit : fibers::fit_local_angles(few, scattered_places())) EXPECT_NEAR(fit.tensor.c[0], 1, 1e-9);
}

}  // namespace
}  // namespace heartgen
