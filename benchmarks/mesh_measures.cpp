// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/mesh_measures.hpp"

#include <algorithm>
#include <numbers>

#include "model/mathematics.hpp"

namespace heartgen::benchmarks {

void add_cell(Angles& angles, const std::array<Vec3, 4>& p) {
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      std::array<std::size_t, 2> rest{};
      std::size_t count = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (k != i && k != j) rest[count++] = k;
      const Vec3 along = p[j] - p[i];
      const Vec3 a = cross(along, p[rest[0]] - p[i]), b = cross(along, p[rest[1]] - p[i]);
      const double cosine = std::clamp(dot(a, b) / (norm(a) * norm(b)), -1.0, 1.0);
      const double degrees = math::acos(cosine) * 180 / std::numbers::pi;
      angles.least = std::min(angles.least, degrees);
      angles.greatest = std::max(angles.greatest, degrees);
    }
  angles.min_volume_mm3 = std::min(angles.min_volume_mm3, dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0])) / 6);
}

Distances summary_of(std::vector<double> distances) {
  if (distances.empty()) return {};
  std::sort(distances.begin(), distances.end());
  return {distances[distances.size() * 99 / 100], distances.back()};
}

}  // namespace heartgen::benchmarks
