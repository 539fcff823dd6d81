// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/label_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace heartgen::validation {
namespace {

/// Shares of the labels at the corners of a cell of voxels; equal labels are added up.
struct Shares {
  std::array<int, 8> label{};
  std::array<double, 8> share{};
  std::size_t count = 0;

  void add(int corner, double weight) {
    for (std::size_t n = 0; n < count; ++n)
      if (label[n] == corner) {
        share[n] += weight;
        return;
      }
    label[count] = corner;
    share[count++] = weight;
  }
  int largest() const {
    std::size_t best = 0;
    for (std::size_t n = 1; n < count; ++n)
      if (share[n] > share[best] || (share[n] == share[best] && label[n] < label[best])) best = n;
    return label[best];
  }
};

}  // namespace

int label_between_voxels(const LabelVolume& labels, const Vec3& lps_mm) {
  const Vec3 index = index_from_lps(labels.grid, lps_mm);
  std::array<std::int64_t, 3> low{}, high{};
  std::array<double, 3> t{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto last = labels.grid.size[a] - 1;
    if (index[axis] < -0.5 || index[axis] > static_cast<double>(last) + 0.5) return 0;
    const double inside = std::clamp(index[axis], 0.0, static_cast<double>(last));
    low[a] = static_cast<std::int64_t>(std::floor(inside));
    high[a] = std::min(low[a] + 1, last);
    t[a] = inside - static_cast<double>(low[a]);
  }
  Shares shares;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const bool x = corner & 1, y = corner & 2, z = corner & 4;
    const double weight = (x ? t[0] : 1 - t[0]) * (y ? t[1] : 1 - t[1]) * (z ? t[2] : 1 - t[2]);
    shares.add(labels(x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2]), weight);
  }
  return shares.largest();
}

}  // namespace heartgen::validation
