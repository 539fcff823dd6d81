// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: order statistics, the 2-medians of a set of grey values, principal axes of point sets.
#pragma once
#include <array>
#include <vector>

#include "model/vec.hpp"

namespace heartgen::image {

/// The value at `fraction` (0 to 1) of the sorted values; 0 for an empty set. Reorders `values`.
double quantile(std::vector<float>& values, double fraction);
inline double median(std::vector<float>& values) { return quantile(values, 0.5); }

struct TwoLevels {
  double low = 0, high = 0;
  double threshold() const { return 0.5 * (low + high); }
};

/// Medians of the two sides of their own middle (Lloyd's iteration in the L1 norm), started from two quantiles.
/// Sorts `values`, which must not be empty.
TwoLevels two_medians(std::vector<float>& values, double low_quantile, double high_quantile);

Vec3 mean(const std::vector<Vec3>& points);

/// Directions of greatest, middle and least extent through the mean, with the standard deviations along them.
struct PrincipalAxes {
  std::array<Vec3, 3> axis;
  std::array<double, 3> deviation{};
};
PrincipalAxes principal_axes(const std::vector<Vec3>& points);

/// Angle between two directions, degrees, 0 to 180.
double angle_deg(const Vec3& a, const Vec3& b);

}  // namespace heartgen::image
