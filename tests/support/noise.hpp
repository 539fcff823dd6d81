// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Noise that is the same on every platform, which std::normal_distribution's is not.
#pragma once
#include <random>

namespace heartgen::testing {

/// The sum of twelve uniform numbers less its mean: variance 1, nearly a normal distribution.
inline double noise(std::mt19937& random) {
  double sum = -6;
  for (int n = 0; n < 12; ++n) sum += static_cast<double>(random()) / 4294967296.0;
  return sum;
}

}  // namespace heartgen::testing
