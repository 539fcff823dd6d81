// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/convex_slices.hpp"

#include <cmath>
#include <vector>

namespace heartgen::image {
namespace {

struct RowEnd {
  std::int64_t row = 0;
  double at = 0;
};

/// The points of a function of the row that lie on its least concave majorant.
std::vector<RowEnd> upper_hull(const std::vector<RowEnd>& ends) {
  std::vector<RowEnd> hull;
  for (const RowEnd& next : ends) {
    while (hull.size() >= 2) {
      const RowEnd &a = hull[hull.size() - 2], &b = hull.back();
      const double turn =
          static_cast<double>(b.row - a.row) * (next.at - a.at) - static_cast<double>(next.row - a.row) * (b.at - a.at);
      if (turn < 0) break;
      hull.pop_back();
    }
    hull.push_back(next);
  }
  return hull;
}

/// Values of the hull at every row from its first to its last.
std::vector<double> along_rows(const std::vector<RowEnd>& hull) {
  std::vector<double> values;
  for (std::size_t n = 0; n + 1 < hull.size(); ++n)
    for (std::int64_t row = hull[n].row; row < hull[n + 1].row; ++row) {
      const double t = static_cast<double>(row - hull[n].row) / static_cast<double>(hull[n + 1].row - hull[n].row);
      values.push_back(hull[n].at + t * (hull[n + 1].at - hull[n].at));
    }
  values.push_back(hull.back().at);
  return values;
}

void fill_slice(const Mask& mask, std::int64_t k, Mask& result) {
  std::vector<RowEnd> left, right;  // left ends with the sign changed: both hulls are upper hulls then
  const auto [nx, ny, nz] = mask.grid.size;
  for (std::int64_t j = 0; j < ny; ++j) {
    std::int64_t first = 0, last = nx - 1;
    while (first < nx && !mask(first, j, k)) ++first;
    if (first == nx) continue;
    while (!mask(last, j, k)) --last;
    left.push_back({j, -static_cast<double>(first)});
    right.push_back({j, static_cast<double>(last)});
  }
  const auto from = along_rows(upper_hull(left)), to = along_rows(upper_hull(right));
  for (std::size_t n = 0; n < from.size(); ++n)
    for (auto i = static_cast<std::int64_t>(std::ceil(-from[n])); static_cast<double>(i) <= to[n]; ++i)
      result(i, left.front().row + static_cast<std::int64_t>(n), k) = 1;
}

}  // namespace

Mask convex_slices(const Mask& mask, double smallest_mm2) {
  Mask result(mask.grid);
  const auto [nx, ny, nz] = mask.grid.size;
  const double pixel_mm2 = mask.grid.spacing_mm.x * mask.grid.spacing_mm.y;
  for (std::int64_t k = 0; k < nz; ++k) {
    std::int64_t pixels = 0;
    for (std::int64_t p = k * nx * ny; p < (k + 1) * nx * ny; ++p) pixels += mask.voxels[static_cast<std::size_t>(p)];
    if (pixels > 0 && static_cast<double>(pixels) * pixel_mm2 >= smallest_mm2) fill_slice(mask, k, result);
  }
  return result;
}

}  // namespace heartgen::image
