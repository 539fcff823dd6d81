// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace heartgen::mesh {
namespace {

double ball_radius(const std::vector<CurvePoint>& points, std::size_t self) {
  double nearest = std::numeric_limits<double>::max(), second = nearest;
  for (std::size_t other = 0; other < points.size(); ++other) {
    if (other == self) continue;
    const double distance = norm(points[other].position_mm - points[self].position_mm);
    if (distance < nearest) {
      second = nearest;
      nearest = distance;
    } else {
      second = std::min(second, distance);
    }
  }
  return std::min({0.6 * second, 0.7 * nearest, 0.9 * points[self].spacing_mm});
}

}  // namespace

std::vector<adapters::CurveBall> balls_along(const std::vector<CurvePoint>& samples) {
  // Distance of each sample to the points kept so far, in units of its spacing. The next point is the sample nearest
  // to them that is at least one spacing away: its neighbour along the curve.
  std::vector<double> gap(samples.size(), std::numeric_limits<double>::max());
  std::vector<CurvePoint> kept;
  for (;;) {
    std::size_t next = samples.size();
    for (std::size_t i = 0; i < samples.size(); ++i)
      if (gap[i] >= 1 && (next == samples.size() || gap[i] < gap[next])) next = i;
    if (next == samples.size()) break;
    kept.push_back(samples[next]);
    gap[next] = 0;  // also where the spacing is 0
    for (std::size_t i = 0; i < samples.size(); ++i)
      gap[i] = std::min(gap[i], norm(samples[i].position_mm - samples[next].position_mm) / samples[i].spacing_mm);
  }
  std::vector<adapters::CurveBall> balls;
  for (std::size_t i = 0; i < kept.size(); ++i) balls.push_back({kept[i].position_mm, ball_radius(kept, i)});
  return balls;
}

}  // namespace heartgen::mesh
