// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/flood.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "generator/image/box_around.hpp"
#include "model/contract.hpp"

namespace heartgen::image {
namespace {

constexpr float level_mm = 0.05F;  // depths closer than this count as equal

Index3 voxel_of(const Grid& grid, std::int64_t offset) {
  const auto row = offset / grid.size[0];
  return {offset % grid.size[0], row % grid.size[1], row / grid.size[1]};
}

/// First-in first-out queues, one per depth level.
struct LevelQueue {
  std::vector<std::vector<std::int64_t>> level;
  std::vector<std::size_t> head;

  explicit LevelQueue(std::size_t levels) : level(levels), head(levels, 0) {}
  void push(std::size_t at, std::int64_t offset) { level[at].push_back(offset); }
};

struct Neighbour {
  Index3 step;
  float length_mm;
};

std::vector<Neighbour> neighbours_26(const Grid& grid) {
  std::vector<Neighbour> result;
  for (std::int64_t k = -1; k <= 1; ++k)
    for (std::int64_t j = -1; j <= 1; ++j)
      for (std::int64_t i = -1; i <= 1; ++i) {
        const Vec3 step{static_cast<double>(i) * grid.spacing_mm.x, static_cast<double>(j) * grid.spacing_mm.y,
                        static_cast<double>(k) * grid.spacing_mm.z};
        if (i != 0 || j != 0 || k != 0) result.push_back({{i, j, k}, static_cast<float>(norm(step))});
      }
  return result;
}

constexpr std::array<Index3, 6> faces = {{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

}  // namespace

ValveBarrier valve_barrier(const Grid& grid, const Landmarks& landmarks, double margin_mm) {
  ValveBarrier barrier(grid);
  const double thick_mm = 2 * std::max({grid.spacing_mm.x, grid.spacing_mm.y, grid.spacing_mm.z});
  unsigned bit = 0;
  for (const auto& [name, valve] : landmarks.valves) {
    if (bit == 4) break;
    const Vec3 normal = normalized(valve.normal);
    const double radius = valve.radius_mm + margin_mm;
    const Box box = box_around(grid, valve.center_mm, radius + thick_mm);
    for (std::int64_t k = box.begin[2]; k < box.end[2]; ++k)
      for (std::int64_t j = box.begin[1]; j < box.end[1]; ++j)
        for (std::int64_t i = box.begin[0]; i < box.end[0]; ++i) {
          const Vec3 at =
              lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          const Vec3 offset = at - valve.center_mm;
          const double height = dot(offset, normal);
          if (std::abs(height) > thick_mm || norm(offset - height * normal) > radius) continue;
          barrier.side(i, j, k) =
              static_cast<std::uint8_t>(barrier.side(i, j, k) | (1U << bit) | ((height >= 0 ? 1U : 0U) << (4 + bit)));
        }
    ++bit;
  }
  return barrier;
}

LabelVolume flood_from_markers(const Mask& mask, const Volume<float>& depth_mm, const std::vector<Marker>& markers,
                               const ValveBarrier& barrier) {
  const Grid& grid = mask.grid;
  const auto level_of = [&](std::size_t v) { return static_cast<std::size_t>(depth_mm.voxels[v] / level_mm); };
  std::size_t levels = 1;
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v]) levels = std::max(levels, level_of(v) + 1);
  LevelQueue queue(levels);
  LabelVolume label(grid);
  for (const Marker& marker : markers) {
    const auto offset = grid.offset(marker.voxel[0], marker.voxel[1], marker.voxel[2]);
    label.voxels[static_cast<std::size_t>(offset)] = marker.label;
    queue.push(levels - 1, offset);
  }
  for (std::size_t now = levels; now-- > 0;) {
    for (; queue.head[now] < queue.level[now].size(); ++queue.head[now]) {
      const std::int64_t offset = queue.level[now][queue.head[now]];
      const auto from = static_cast<std::size_t>(offset);
      const Index3 at = voxel_of(grid, offset);
      for (const Index3& step : faces) {
        if (!grid.contains(at[0] + step[0], at[1] + step[1], at[2] + step[2])) continue;
        const auto next = grid.offset(at[0] + step[0], at[1] + step[1], at[2] + step[2]);
        const auto to = static_cast<std::size_t>(next);
        if (!mask.voxels[to] || label.voxels[to] || barrier.blocks(from, to)) continue;
        label.voxels[to] = label.voxels[from];
        queue.push(std::min(now, level_of(to)), next);
      }
    }
    queue.level[now] = {};
  }
  return label;
}

Volume<float> geodesic_distance(const Mask& mask, const Mask& start, double limit_mm) {
  HEARTGEN_EXPECTS(mask.grid == start.grid);
  const Grid& grid = mask.grid;
  Volume<float> distance(grid, std::numeric_limits<float>::infinity());
  using Entry = std::pair<float, std::int64_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t v = 0; v < mask.voxels.size(); ++v)
    if (mask.voxels[v] && start.voxels[v]) {
      distance.voxels[v] = 0;
      queue.emplace(0.0F, static_cast<std::int64_t>(v));
    }
  const auto neighbours = neighbours_26(grid);
  while (!queue.empty()) {
    const auto [length, offset] = queue.top();
    queue.pop();
    if (length > distance.voxels[static_cast<std::size_t>(offset)]) continue;
    const Index3 at = voxel_of(grid, offset);
    for (const auto& [step, step_mm] : neighbours) {
      const Index3 to{at[0] + step[0], at[1] + step[1], at[2] + step[2]};
      if (!grid.contains(to[0], to[1], to[2]) || !mask(to[0], to[1], to[2])) continue;
      const float reached = length + step_mm;
      float& best = distance(to[0], to[1], to[2]);
      if (static_cast<double>(reached) > limit_mm || reached >= best) continue;
      best = reached;
      queue.emplace(reached, grid.offset(to[0], to[1], to[2]));
    }
  }
  return distance;
}

}  // namespace heartgen::image
