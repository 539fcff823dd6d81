// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/value_grid.hpp"

#include <algorithm>
#include <cmath>

namespace heartgen::validation {
namespace {

constexpr int margin = 2;

/// Values of one place, joined.
struct Joined {
  Join join;
  double sum = 0, count = 0, largest = -1e300;

  void add(double v) {
    if (std::isfinite(v)) sum += v, count += 1, largest = std::max(largest, v);
  }
  double value() const { return count == 0 ? std::nan("") : join == Join::mean ? sum / count : largest; }
};

void fill_neighbours(const ValueGrid& grid, Join join, std::vector<double>& values) {
  const auto before = values;
  const auto& n = grid.count;
  std::size_t at = 0;
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
      for (std::int64_t i = 0; i < n[0]; ++i, ++at) {
        if (std::isfinite(before[at])) continue;
        Joined around{join};
        for (std::int64_t c = std::max<std::int64_t>(k - 1, 0); c <= std::min(k + 1, n[2] - 1); ++c)
          for (std::int64_t b = std::max<std::int64_t>(j - 1, 0); b <= std::min(j + 1, n[1] - 1); ++b)
            for (std::int64_t a = std::max<std::int64_t>(i - 1, 0); a <= std::min(i + 1, n[0] - 1); ++a)
              around.add(before[static_cast<std::size_t>((c * n[1] + b) * n[0] + a)]);
        values[at] = around.value();
      }
}

}  // namespace

ValueGrid make_value_grid(const std::vector<Vec3>& nodes_mm) {
  ValueGrid grid;
  if (nodes_mm.empty()) return grid;
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const Vec3& p : nodes_mm)
    for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
  for (int a = 0; a < 3; ++a) {
    grid.low_mm[a] = low[a] - margin * grid.spacing_mm;
    const auto cubes = static_cast<std::int64_t>((high[a] - low[a]) / grid.spacing_mm) + 1 + 2 * margin;
    grid.count[static_cast<std::size_t>(a)] = std::min<std::int64_t>(cubes, 160);
  }
  for (const Vec3& p : nodes_mm) {
    std::array<std::int64_t, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<int>(a);
      const double place = (p[axis] - grid.low_mm[axis]) / grid.spacing_mm;
      at[a] = std::clamp<std::int64_t>(static_cast<std::int64_t>(place), 0, grid.count[a] - 1);
    }
    grid.cube.push_back(static_cast<std::int32_t>((at[2] * grid.count[1] + at[1]) * grid.count[0] + at[0]));
  }
  return grid;
}

std::vector<double> grid_values(const ValueGrid& grid, const std::vector<double>& values, Join join) {
  std::vector<Joined> cubes(static_cast<std::size_t>(grid.count[0] * grid.count[1] * grid.count[2]), Joined{join});
  for (std::size_t n = 0; n < values.size(); ++n) cubes[static_cast<std::size_t>(grid.cube[n])].add(values[n]);
  std::vector<double> result;
  result.reserve(cubes.size());
  for (const Joined& cube : cubes) result.push_back(cube.value());
  for (int pass = 0; pass < margin; ++pass) fill_neighbours(grid, join, result);
  return result;
}

}  // namespace heartgen::validation
