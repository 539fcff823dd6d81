// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What one element does in total variation inpainting (inpaint.hpp), the same on graphs and on grids.
/// `around(visit)` calls visit(other, distance_mm) for the neighbours of an element, always in the same order;
/// `axes` and `slope` are indexed as the neighbours are.
#pragma once
#include <cmath>

#include "model/axis_tensor.hpp"

namespace heartgen::fibers::inpainting {

/// The squared Frobenius norm counts off-diagonal components twice, as the matrices do.
inline double squared_difference(const AxisTensor& a, const AxisTensor& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 6; ++c) {
    const double d = a.c[c] - b.c[c];
    sum += (c < 3 ? 1 : 2) * d * d;
  }
  return sum;
}

/// Mean over the neighbours that is_known(other); zero where there are none.
template <class Around, class Axes, class IsKnown>
AxisTensor mean_of_known(const Around& around, const Axes& axes, const IsKnown& is_known) {
  AxisTensor sum;
  double total = 0;
  around([&](std::size_t other, double) {
    if (!is_known(other)) return;
    sum += axes[other];
    ++total;
  });
  return total > 0 ? (1 / total) * sum : sum;
}

/// 1 / |grad u| at an element, from the differences to its neighbours.
template <class Around, class Axes, class IsKnown>
double inverse_slope(const Around& around, const Axes& axes, const IsKnown& is_known, const AxisTensor& own) {
  constexpr double min_slope_per_mm = 1e-3;
  double sum = min_slope_per_mm * min_slope_per_mm;
  around([&](std::size_t other, double h) {
    if (is_known(other)) sum += squared_difference(own, axes[other]) / (2 * h * h);
  });
  return 1 / std::sqrt(sum);
}

/// One Jacobi step of div(grad u / |grad u|) = 0.
template <class Around, class Axes, class Slope, class IsKnown>
AxisTensor relaxed(const Around& around, const Axes& axes, const Slope& slope, const IsKnown& is_known,
                   const AxisTensor& own, double own_slope) {
  AxisTensor sum;
  double total = 0;
  around([&](std::size_t other, double h) {
    if (!is_known(other)) return;
    const double weight = (own_slope + slope[other]) / (h * h);
    sum += weight * axes[other];
    total += weight;
  });
  return total > 0 ? (1 / total) * sum : own;
}

}  // namespace heartgen::fibers::inpainting
