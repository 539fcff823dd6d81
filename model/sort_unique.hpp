// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Sets as sorted vectors: their order is that of the values, whatever was found first.
#pragma once
#include <algorithm>
#include <vector>

namespace heartgen {

/// Sorts the values and keeps one of each.
template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace heartgen
