#include "generator/fibers/atlas_figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace heart::fibers {
namespace {

constexpr std::size_t most_samples = 20000;

/// Of `from`, every so-manieth.
DepthSamples thinned(const DepthSamples& from) {
  const std::size_t step = from.depth.size() / most_samples + 1;
  DepthSamples kept;
  for (std::size_t n = 0; n < from.depth.size(); n += step) {
    kept.depth.push_back(from.depth[n]);
    kept.helix_deg.push_back(from.helix_deg[n]);
  }
  return kept;
}

DepthSamples of_atlas(const AngleSamples& samples, const std::vector<double>& depth) {
  atlas::WallPoint own;  // the tensors' frame
  own.normal = {0, 0, 1}, own.longitudinal = {0, 1, 0}, own.circumferential = {1, 0, 0};
  DepthSamples result;
  for (std::size_t n = 0; n < depth.size(); ++n) {
    result.depth.push_back(static_cast<float>(depth[n]));
    result.helix_deg.push_back(static_cast<float>(helix_angle_deg(own, atlas::leading_axis(samples.tensor[n]))));
  }
  return thinned(result);
}

DepthSamples of_points(const PointWalls& walls, bool left, const std::vector<Vec3>& carried,
                       const std::vector<std::uint8_t>& use) {
  DepthSamples result;
  for (std::size_t n = 0; n < carried.size(); ++n) {
    if (!use[n] || !walls.known[n] || walls.left_share[n] != (left ? 1 : 0)) continue;
    const auto& at = left ? walls.lv[n] : walls.rv[n];
    result.depth.push_back(static_cast<float>(at.depth));
    result.helix_deg.push_back(static_cast<float>(helix_angle_deg(at, carried[n])));
  }
  return thinned(result);
}

double turn_p99(const atlas::FiberAtlas& atlas) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  edges.reserve(6 * atlas.cells.size());
  for (const Cell& cell : atlas.cells)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) edges.push_back(std::minmax(cell[a], cell[b]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<double> turns;
  for (const auto& [a, b] : edges) {
    const Vec3 &f = atlas.fiber[static_cast<std::size_t>(a)], &g = atlas.fiber[static_cast<std::size_t>(b)];
    const double length =
        norm(atlas.points_mm[static_cast<std::size_t>(a)] - atlas.points_mm[static_cast<std::size_t>(b)]);
    if (f == Vec3{} || g == Vec3{} || length <= 0) continue;
    turns.push_back(std::atan2(norm(cross(f, g)), std::abs(dot(f, g))) * 180 / std::numbers::pi / length);
  }
  if (turns.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(turns.size() - 1));
  std::nth_element(turns.begin(), turns.begin() + at, turns.end());
  return turns[static_cast<std::size_t>(at)];
}

}  // namespace

AtlasFigures atlas_figures(const Hearts& hearts, const atlas::FiberAtlas& atlas, const PointWalls& walls,
                           const std::vector<Vec3>& carried, const std::vector<std::uint8_t>& use) {
  AtlasFigures figures;
  figures.atlas = {of_atlas(hearts.by_place.lv, hearts.atlas_depth.lv),
                   of_atlas(hearts.by_place.rv, hearts.atlas_depth.rv)};
  figures.carried = {of_points(walls, true, carried, use), of_points(walls, false, carried, use)};
  figures.turn_p99_deg_per_mm = turn_p99(atlas);
  return figures;
}

}  // namespace heart::fibers
