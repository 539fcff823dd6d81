// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Order statistics of a sample.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

namespace heartgen::validation {

/// The q-quantile (0 .. 1), linear between order statistics; 0 for an empty sample. Sorts its copy.
inline double quantile(std::vector<double> sample, double q) {
  if (sample.empty()) return 0;
  std::sort(sample.begin(), sample.end());
  const double at = q * static_cast<double>(sample.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const auto high = std::min(low + 1, sample.size() - 1);
  return sample[low] + (at - static_cast<double>(low)) * (sample[high] - sample[low]);
}

}  // namespace heartgen::validation
