#include "validation/angle_grid.hpp"

#include <algorithm>
#include <cmath>

namespace heart::validation {
namespace {

void fill_neighbours(AngleGrid& grid) {
  const auto before = grid.angle_deg;
  const auto& n = grid.count;
  std::size_t at = 0;
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
      for (std::int64_t i = 0; i < n[0]; ++i, ++at) {
        if (std::isfinite(before[at])) continue;
        double sum = 0, count = 0;
        for (int step = 0; step < 27; ++step) {
          const std::int64_t a = i + step % 3 - 1, b = j + step / 3 % 3 - 1, c = k + step / 9 - 1;
          if (a < 0 || b < 0 || c < 0 || a >= n[0] || b >= n[1] || c >= n[2]) continue;
          const double v = before[static_cast<std::size_t>((c * n[1] + b) * n[0] + a)];
          if (std::isfinite(v)) sum += v, count += 1;
        }
        if (count > 0) grid.angle_deg[at] = sum / count;
      }
}

}  // namespace

AngleGrid angle_grid(const TetMesh& walls, const std::vector<double>& helix_deg) {
  AngleGrid grid;
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (std::size_t n = 0; n < helix_deg.size(); ++n)
    if (std::isfinite(helix_deg[n]))
      for (int a = 0; a < 3; ++a)
        low[a] = std::min(low[a], walls.nodes_mm[n][a]), high[a] = std::max(high[a], walls.nodes_mm[n][a]);
  if (low.x > high.x) return grid;
  constexpr int margin = 2;
  std::size_t total = 1;
  for (int a = 0; a < 3; ++a) {
    grid.low_mm[a] = low[a] - margin * grid.spacing_mm;
    const auto cubes = static_cast<std::int64_t>((high[a] - low[a]) / grid.spacing_mm) + 1 + 2 * margin;
    grid.count[static_cast<std::size_t>(a)] = std::min<std::int64_t>(cubes, 160);
    total *= static_cast<std::size_t>(grid.count[static_cast<std::size_t>(a)]);
  }
  std::vector<double> sum(total, 0), count(total, 0);
  for (std::size_t n = 0; n < helix_deg.size(); ++n) {
    if (!std::isfinite(helix_deg[n])) continue;
    std::array<std::int64_t, 3> cube{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<int>(a);
      const double place = (walls.nodes_mm[n][axis] - grid.low_mm[axis]) / grid.spacing_mm;
      cube[a] = std::clamp<std::int64_t>(static_cast<std::int64_t>(place), 0, grid.count[a] - 1);
    }
    const auto at = static_cast<std::size_t>((cube[2] * grid.count[1] + cube[1]) * grid.count[0] + cube[0]);
    sum[at] += helix_deg[n], count[at] += 1;
  }
  grid.angle_deg.resize(total);
  for (std::size_t v = 0; v < total; ++v) grid.angle_deg[v] = count[v] > 0 ? sum[v] / count[v] : std::nan("");
  for (int pass = 0; pass < margin; ++pass) fill_neighbours(grid);
  return grid;
}

}  // namespace heart::validation
