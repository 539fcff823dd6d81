// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Order statistics without sorting. All reorder the values, which must not be empty; ties and thread counts do not
/// matter.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "model/contract.hpp"

namespace heartgen {

/// The element `rank`, from 0, of the sorted values.
template <class T>
T ranked(std::vector<T>& values, std::size_t rank) {
  HEARTGEN_EXPECTS(rank < values.size());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Of an even number of values the greater of the two in the middle.
template <class T>
T upper_median(std::vector<T>& values) {
  HEARTGEN_EXPECTS(!values.empty());
  return ranked(values, values.size() / 2);
}

/// Of an even number of values the lesser of the two in the middle.
template <class T>
T lower_median(std::vector<T>& values) {
  HEARTGEN_EXPECTS(!values.empty());
  return ranked(values, (values.size() - 1) / 2);
}

/// The value below which a share (0 to 1) of the others lies: element share (n - 1), rounded down.
template <class T>
T quantile(std::vector<T>& values, double share) {
  HEARTGEN_EXPECTS(!values.empty() && share >= 0 && share <= 1);
  return ranked(values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

}  // namespace heartgen
