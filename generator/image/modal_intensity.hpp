// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What a tissue is grey like, from values that hold mixtures with its neighbours as well.
#pragma once
#include <vector>

namespace heartgen::image {

/// Median of those values that lie in the window of `width_hu` which holds most of them (the lowest of equals); 0 for
/// no values. Mixtures with what lies beyond a thin wall spread over all grey values between the two: they shift the
/// median of all values, but hardly this one. Sorts `values`.
double modal_intensity(std::vector<float>& values, double width_hu);

/// Wide enough for muscle under the noise of a CT, and too narrow for its mixtures with fat.
constexpr double muscle_window_hu = 50;

}  // namespace heartgen::image
