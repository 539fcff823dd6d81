// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/distance_map.hpp"

#include <cmath>
#include <limits>

namespace heartgen::validation {
namespace {

constexpr double unreached = 1e36;  // squared mm

/// One line of squared distances, in place. `place` and `from` are scratch of at least n and n + 1.
void transform_line(std::vector<double>& line, std::size_t n, double spacing, std::vector<std::size_t>& place,
                    std::vector<double>& from, std::vector<double>& out) {
  std::size_t count = 0;
  const auto x = [spacing](std::size_t i) { return spacing * static_cast<double>(i); };
  for (std::size_t i = 0; i < n; ++i) {
    if (line[i] >= unreached) continue;
    double meet = -std::numeric_limits<double>::infinity();
    while (count > 0) {
      const std::size_t top = place[count - 1];
      meet = ((line[i] + x(i) * x(i)) - (line[top] + x(top) * x(top))) / (2 * (x(i) - x(top)));
      if (meet > from[count - 1]) break;
      --count;
      meet = -std::numeric_limits<double>::infinity();
    }
    place[count] = i;
    from[count] = meet;
    ++count;
  }
  if (count == 0) return;
  std::size_t k = 0;
  for (std::size_t i = 0; i < n; ++i) {
    while (k + 1 < count && from[k + 1] < x(i)) ++k;
    const double d = x(i) - x(place[k]);
    out[i] = line[place[k]] + d * d;
  }
  for (std::size_t i = 0; i < n; ++i) line[i] = out[i];
}

}  // namespace

std::vector<double> distance_to(const Grid& grid, const std::vector<std::uint8_t>& feature) {
  std::vector<double> squared(feature.size());
  for (std::size_t v = 0; v < feature.size(); ++v) squared[v] = feature[v] ? 0 : unreached;
  const std::size_t size[3] = {static_cast<std::size_t>(grid.size[0]), static_cast<std::size_t>(grid.size[1]),
                               static_cast<std::size_t>(grid.size[2])};
  const std::size_t stride[3] = {1, size[0], size[0] * size[1]};
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t n = size[axis], u = static_cast<std::size_t>((axis + 1) % 3),
                      w = static_cast<std::size_t>((axis + 2) % 3);
    std::vector<double> line(n), from(n + 1), out(n);
    std::vector<std::size_t> place(n);
    for (std::size_t b = 0; b < size[w]; ++b)
      for (std::size_t a = 0; a < size[u]; ++a) {
        const std::size_t start = a * stride[u] + b * stride[w];
        for (std::size_t i = 0; i < n; ++i) line[i] = squared[start + i * stride[axis]];
        transform_line(line, n, grid.spacing_mm[axis], place, from, out);
        for (std::size_t i = 0; i < n; ++i) squared[start + i * stride[axis]] = line[i];
      }
  }
  for (double& v : squared) v = v >= unreached ? 1e18 : std::sqrt(v);
  return squared;
}

}  // namespace heartgen::validation
