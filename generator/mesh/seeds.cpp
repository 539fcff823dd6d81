// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/seeds.hpp"

#include <algorithm>
#include <array>
#include <optional>

namespace heartgen::mesh {
namespace {

struct Component {
  std::int64_t voxels = 0;
  std::array<Index3, 6> outermost;  // lowest and highest along i, j, k
};

void take(Component& component, const Index3& at) {
  if (component.voxels++ == 0) component.outermost.fill(at);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (at[axis] < component.outermost[2 * axis][axis]) component.outermost[2 * axis] = at;
    if (at[axis] > component.outermost[2 * axis + 1][axis]) component.outermost[2 * axis + 1] = at;
  }
}

Component flood(const LabelVolume& labels, const Index3& seed, std::vector<bool>& visited) {
  const auto& grid = labels.grid;
  const auto offset = [&](const Index3& at) { return static_cast<std::size_t>(grid.offset(at[0], at[1], at[2])); };
  Component component;
  std::vector<Index3> front{seed};
  visited[offset(seed)] = true;
  while (!front.empty()) {
    const Index3 at = front.back();
    front.pop_back();
    take(component, at);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int sign : {-1, 1}) {
        Index3 next = at;
        next[axis] += sign;
        if (next[axis] < 0 || next[axis] >= grid.size[axis]) continue;
        const auto place = offset(next);
        if (visited[place] || labels.voxels[place] != labels.voxels[offset(at)]) continue;
        visited[place] = true;
        front.push_back(next);
      }
  }
  return component;
}

std::vector<Component> components_of(const LabelVolume& labels) {
  std::vector<Component> components;
  std::vector<bool> visited(labels.voxels.size(), false);
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < labels.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < labels.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < labels.grid.size[0]; ++i, ++voxel)
        if (!visited[voxel]) components.push_back(flood(labels, {i, j, k}, visited));
  std::stable_sort(components.begin(), components.end(),
                   [](const Component& a, const Component& b) { return a.voxels > b.voxels; });
  return components;
}

std::optional<Vec3> bisect(Vec3 inside, Vec3 outside, const std::function<int(const Vec3&)>& label_at) {
  const int label = label_at(inside);
  if (label_at(outside) == label) return std::nullopt;
  for (int step = 0; step < 24; ++step) {
    const Vec3 middle = 0.5 * (inside + outside);
    (label_at(middle) == label ? inside : outside) = middle;
  }
  return 0.5 * (inside + outside);
}

}  // namespace

std::vector<Vec3> surface_seeds(const LabelVolume& labels, const std::function<int(const Vec3&)>& label_at,
                                const std::function<double(const Vec3&)>& apart_mm) {
  std::vector<Vec3> seeds;
  for (const auto& component : components_of(labels))
    for (std::size_t side = 0; side < 6; ++side) {
      const Index3& at = component.outermost[side];
      Vec3 voxel{static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
      const Vec3 inside = lps_from_index(labels.grid, voxel);
      voxel[static_cast<int>(side / 2)] += side % 2 == 0 ? -1 : 1;
      const auto point = bisect(inside, lps_from_index(labels.grid, voxel), label_at);
      if (!point) continue;
      const double apart = apart_mm(*point);
      const bool near_another =
          std::any_of(seeds.begin(), seeds.end(), [&](const Vec3& s) { return norm(s - *point) < apart; });
      if (!near_another) seeds.push_back(*point);
    }
  return seeds;
}

}  // namespace heartgen::mesh
