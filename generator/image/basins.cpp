// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/basins.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "generator/image/distance.hpp"

namespace heartgen::image {
namespace {

/// Union-find over basins; the root is the one with the highest peak.
struct Forest {
  BasinSettings settings;
  std::vector<std::int32_t> parent;
  std::vector<float> peak;

  std::int32_t root(std::int32_t a) {
    auto at = static_cast<std::size_t>(a);
    while (parent[at] != static_cast<std::int32_t>(at)) {
      parent[at] = parent[static_cast<std::size_t>(parent[at])];
      at = static_cast<std::size_t>(parent[at]);
    }
    return static_cast<std::int32_t>(at);
  }
  std::int32_t add(float depth) {
    parent.push_back(static_cast<std::int32_t>(parent.size()));
    peak.push_back(depth);
    return parent.back();
  }
  /// Joins b into a or a into b where the saddle between them is high.
  void meet(std::int32_t a, std::int32_t b, float saddle) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (peak[static_cast<std::size_t>(a)] < peak[static_cast<std::size_t>(b)]) std::swap(a, b);
    const float lower = peak[static_cast<std::size_t>(b)];
    if (lower <= settings.peak_level_mm || lower - saddle < settings.noise_drop_mm ||
        saddle > settings.join_above_ratio * lower)
      parent[static_cast<std::size_t>(b)] = a;
  }
};

/// Offsets of the up to six neighbours of a voxel that exist.
struct Faces {
  std::array<std::int64_t, 6> at{};
  int count = 0;

  Faces(const Grid& grid, std::int64_t offset) {
    std::int64_t rest = offset, stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t index = rest % grid.size[axis];
      rest /= grid.size[axis];
      if (index > 0) at[static_cast<std::size_t>(count++)] = offset - stride;
      if (index + 1 < grid.size[axis]) at[static_cast<std::size_t>(count++)] = offset + stride;
      stride *= grid.size[axis];
    }
  }
};

std::vector<std::int64_t> deepest_first(const Volume<float>& depth) {
  std::vector<std::int64_t> order;
  for (std::size_t v = 0; v < depth.voxels.size(); ++v)
    if (depth.voxels[v] > 0) order.push_back(static_cast<std::int64_t>(v));
  std::stable_sort(order.begin(), order.end(), [&](std::int64_t a, std::int64_t b) {
    return depth.voxels[static_cast<std::size_t>(a)] > depth.voxels[static_cast<std::size_t>(b)];
  });
  return order;
}

/// Label of every voxel: the root of its basin + 1; basins that stayed shallow get 0.
Volume<std::int32_t> flood(const Volume<float>& depth, const BasinSettings& settings) {
  Volume<std::int32_t> label(depth.grid, -1);
  Forest forest{settings, {}, {}};
  for (const auto offset : deepest_first(depth)) {
    const auto here = static_cast<std::size_t>(offset);
    std::int64_t steepest = -1;
    const Faces faces(depth.grid, offset);
    for (int n = 0; n < faces.count; ++n) {
      const auto next = static_cast<std::size_t>(faces.at[static_cast<std::size_t>(n)]);
      if (label.voxels[next] < 0) continue;
      if (steepest < 0 || depth.voxels[next] > depth.voxels[static_cast<std::size_t>(steepest)])
        steepest = static_cast<std::int64_t>(next);
    }
    label.voxels[here] =
        steepest < 0 ? forest.add(depth.voxels[here]) : label.voxels[static_cast<std::size_t>(steepest)];
    for (int n = 0; n < faces.count; ++n) {
      const auto next = static_cast<std::size_t>(faces.at[static_cast<std::size_t>(n)]);
      if (label.voxels[next] >= 0) forest.meet(label.voxels[here], label.voxels[next], depth.voxels[here]);
    }
  }
  for (auto& l : label.voxels) {
    const auto root = l < 0 ? -1 : forest.root(l);
    l = root < 0 || forest.peak[static_cast<std::size_t>(root)] <= settings.peak_level_mm ? 0 : root + 1;
  }
  return label;
}

/// Renumbers labels by falling volume (the first of equals keeps its place); returns how many there are.
std::int32_t renumber(Volume<std::int32_t>& label) {
  if (label.voxels.empty()) return 0;
  const auto highest = *std::max_element(label.voxels.begin(), label.voxels.end());
  std::vector<std::int64_t> volume(static_cast<std::size_t>(highest) + 1, 0);
  for (const auto l : label.voxels) ++volume[static_cast<std::size_t>(l)];
  volume[0] = 0;
  std::vector<std::size_t> order(volume.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return volume[a] > volume[b]; });
  std::vector<std::int32_t> number(volume.size(), 0);
  std::int32_t next = 0;
  for (const auto l : order)
    if (volume[l] > 0) number[l] = ++next;
  for (auto& l : label.voxels) l = number[static_cast<std::size_t>(l)];
  return next;
}

}  // namespace

double Basins::width(std::int32_t a, std::int32_t b) const {
  const auto found = contacts.find(std::minmax(a, b));
  return found == contacts.end() ? 0 : found->second.width_mm;
}

void measure_contacts(Basins& basins) {
  basins.contacts.clear();
  const Grid& grid = basins.label.grid;
  const double face_mm2 = grid.spacing_mm.x * grid.spacing_mm.x;
  const std::array<std::int64_t, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++v) {
        const Index3 here{i, j, k};
        const auto a = basins.label.voxels[v];
        for (std::size_t axis = 0; a > 0 && axis < 3; ++axis) {
          if (here[axis] + 1 >= grid.size[axis]) continue;
          const std::size_t other = v + static_cast<std::size_t>(stride[axis]);
          const auto b = basins.label.voxels[other];
          if (b == 0 || a == b) continue;
          Contact& contact = basins.contacts[std::minmax(a, b)];
          const float width = std::min(basins.depth_mm.voxels[v], basins.depth_mm.voxels[other]);
          contact.width_mm = std::max(contact.width_mm, static_cast<double>(width));
          contact.area_mm2 += face_mm2;
        }
      }
}

Basins divide_at_constrictions(const Mask& blood) {
  Mask outside(blood.grid);
  std::transform(blood.voxels.begin(), blood.voxels.end(), outside.voxels.begin(),
                 [](std::uint8_t set) { return set == 0; });
  return divide_at_constrictions(distance_to(outside), {});
}

Basins divide_at_constrictions(Volume<float> depth_mm, const BasinSettings& settings) {
  Basins basins;
  basins.depth_mm = std::move(depth_mm);
  basins.label = flood(basins.depth_mm, settings);
  basins.count = renumber(basins.label);
  measure_contacts(basins);
  return basins;
}

}  // namespace heartgen::image
