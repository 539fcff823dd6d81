#include "generator/atlas/layers.hpp"

#include <algorithm>

namespace heart::atlas {

std::vector<std::int64_t> known_voxels(const Mask& known) {
  std::vector<std::int64_t> result;
  for (std::size_t v = 0; v < known.voxels.size(); ++v)
    if (known.voxels[v]) result.push_back(static_cast<std::int64_t>(v));
  return result;
}

std::vector<std::int64_t> unknown_around(const Mask& known, const std::vector<std::int64_t>& around) {
  const Grid& g = known.grid;
  Mask found(g);
  std::vector<std::int64_t> result;
  for (const auto v : around) {
    const std::int64_t i = v % g.size[0], j = v / g.size[0] % g.size[1], k = v / (g.size[0] * g.size[1]);
    for (const auto& s : neighbors26) {
      if (!g.contains(i + s[0], j + s[1], k + s[2])) continue;
      const auto at = static_cast<std::size_t>(g.offset(i + s[0], j + s[1], k + s[2]));
      if (known.voxels[at] || found.voxels[at]) continue;
      found.voxels[at] = 1;
      result.push_back(static_cast<std::int64_t>(at));
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace heart::atlas
