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

}  // namespace heartgen::image
