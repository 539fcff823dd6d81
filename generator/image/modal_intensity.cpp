// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/modal_intensity.hpp"

#include <algorithm>
#include <cstddef>

namespace heartgen::image {

double modal_intensity(std::vector<float>& values, double width_hu) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  std::size_t begin = 0, end = 0, first = 0, most = 0;
  for (; end < values.size(); ++end) {
    while (static_cast<double>(values[end]) - static_cast<double>(values[begin]) > width_hu) ++begin;
    if (end + 1 - begin <= most) continue;
    most = end + 1 - begin;
    first = begin;
  }
  return static_cast<double>(values[first + most / 2]);
}

}  // namespace heartgen::image
