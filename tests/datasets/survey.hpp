// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A walk over the heart of a phantom model on a regular grid: what touches what, how large everything is.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "datasets/phantom/body.hpp"
#include "generator/parallel/threads.hpp"
#include "model/volume.hpp"

namespace heartgen::phantom {

struct Survey {
  LabelVolume regions;
  Volume<std::uint8_t> tissues;
};

/// Samples the box around the heart of the model.
inline Survey survey_heart(const HeartModel& model, double spacing_mm) {
  const Landmarks marks = landmarks_of(model);
  const Vec3 middle = 0.5 * (marks.seeds_mm.at("lv_blood") + marks.seeds_mm.at("ra_blood"));
  const Vec3 low = middle - Vec3{112, 90, 90}, high = middle + Vec3{112, 90, 115};
  Grid grid;
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  grid.origin_mm = low;
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.size[axis] = static_cast<std::int64_t>((high - low)[static_cast<int>(axis)] / spacing_mm) + 1;
  Survey survey{LabelVolume(grid), Volume<std::uint8_t>(grid)};
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const Vec3 p =
              lps_from_index(grid, Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          const Sample sample = sample_at(*model.anatomy, p);
          survey.regions(i, j, k) = tag(sample.region);
          survey.tissues(i, j, k) = static_cast<std::uint8_t>(sample.tissue);
        }
  });
  return survey;
}

/// Calls visit(a, b) with the offsets of every pair of 6-neighbours.
template <class Visit>
void for_each_contact(const Grid& grid, const Visit& visit) {
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        for (int axis = 0; axis < 3; ++axis) {
          const std::int64_t a = i + (axis == 0), b = j + (axis == 1), c = k + (axis == 2);
          if (grid.contains(a, b, c)) visit(std::array{i, j, k}, std::array{a, b, c});
        }
}

inline double volume_ml(const LabelVolume& labels, Region region) {
  std::int64_t count = 0;
  for (const auto voxel : labels.voxels) count += voxel == tag(region);
  return static_cast<double>(count) * labels.grid.voxel_volume_mm3() / 1000;
}

/// Sizes (ml) of the 6-connected components of the voxels where inside(offset) holds, largest first.
template <class Inside>
std::vector<double> component_volumes_ml(const Grid& grid, const Inside& inside) {
  std::vector<char> seen(static_cast<std::size_t>(grid.voxel_count()), 0);
  std::vector<double> sizes;
  const std::int64_t step[3] = {1, grid.size[0], grid.size[0] * grid.size[1]};
  for (std::int64_t start = 0; start < grid.voxel_count(); ++start) {
    if (seen[static_cast<std::size_t>(start)] || !inside(start)) continue;
    std::vector<std::int64_t> stack{start};
    seen[static_cast<std::size_t>(start)] = 1;
    std::int64_t count = 0;
    while (!stack.empty()) {
      const auto at = stack.back();
      stack.pop_back();
      ++count;
      const std::int64_t index[3] = {at % grid.size[0], at / grid.size[0] % grid.size[1], at / step[2]};
      for (int face = 0; face < 6; ++face) {
        const auto axis = static_cast<std::size_t>(face / 2);
        const std::int64_t to = index[axis] + (face % 2 ? 1 : -1);
        if (to < 0 || to >= grid.size[axis]) continue;
        const auto next = at + (face % 2 ? 1 : -1) * step[axis];
        if (seen[static_cast<std::size_t>(next)] || !inside(next)) continue;
        seen[static_cast<std::size_t>(next)] = 1;
        stack.push_back(next);
      }
    }
    sizes.push_back(static_cast<double>(count) * grid.voxel_volume_mm3() / 1000);
  }
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

}  // namespace heartgen::phantom
