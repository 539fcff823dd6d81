// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/image/resample.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "generator/image/isotropic_distance.hpp"
#include "generator/parallel/threads.hpp"
#include "model/crop.hpp"

namespace heartgen::image {
namespace {

// Of the labels: their steps vanish, and what is a voxel thin stays. Labels clearly coarser than the grid do not beat
// with it, and trabeculae would fill.
constexpr double smoothing_voxels = 0.7, coarser = 1.3;

/// The voxels that interpolation on `grid` reads, and as many around them as smoothing reaches.
Box box_around(const Grid& labels, const Grid& grid, std::int64_t margin) {
  Box box{labels.size, {0, 0, 0}};
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (int axis = 0; axis < 3; ++axis)
      index[axis] = (corner >> axis) & 1 ? static_cast<double>(grid.size[static_cast<std::size_t>(axis)] - 1) : 0;
    const Vec3 at = index_from_lps(labels, lps_from_index(grid, index));
    for (int axis = 0; axis < 3; ++axis) {
      const auto n = static_cast<std::size_t>(axis);
      const auto low = static_cast<std::int64_t>(std::floor(at[axis])) - margin;
      box.begin[n] = std::clamp<std::int64_t>(std::min(box.begin[n], low), 0, labels.size[n]);
      box.end[n] = std::clamp<std::int64_t>(std::max(box.end[n], low + 2 * margin + 2), 0, labels.size[n]);
    }
  }
  return box;
}

std::vector<std::uint8_t> values_of(const LabelVolume& labels) {
  std::array<bool, 256> found{};
  for (const auto label : labels.voxels) found[label] = true;
  std::vector<std::uint8_t> values;
  for (std::size_t value = 0; value < found.size(); ++value)
    if (found[value]) values.push_back(static_cast<std::uint8_t>(value));
  return values;
}

/// By linear interpolation; 0 beyond.
Volume<float> sampled_on(const Volume<float>& share, const Grid& grid) {
  Volume<float> result(grid);
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i) {
          const Vec3 at = index_from_lps(
              share.grid,
              lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
          if (share.grid.contains(std::llround(at.x), std::llround(at.y), std::llround(at.z)))
            result(i, j, k) = static_cast<float>(sample_linear(share, at));
        }
  });
  return result;
}

}  // namespace

Vec3 voxel_center(const Grid& grid, std::int64_t v) {
  const auto nx = grid.size[0], ny = grid.size[1];
  const std::int64_t i = v % nx, j = v / nx % ny, k = v / (nx * ny);
  return lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
}

Grid isotropic_grid_around(const LabelVolume& labels, const std::function<bool(std::uint8_t)>& wanted,
                           double spacing_mm, double margin_mm) {
  std::array<bool, 256> table{};
  for (int value = 0; value < 256; ++value)
    table[static_cast<std::size_t>(value)] = wanted(static_cast<std::uint8_t>(value));
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    if (!table[labels.voxels[v]]) continue;
    const Vec3 p = voxel_center(labels.grid, static_cast<std::int64_t>(v));
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  Grid grid;
  grid.spacing_mm = {spacing_mm, spacing_mm, spacing_mm};
  if (low.x > high.x) return grid;
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin_mm[axis] = low[axis] - margin_mm;
    grid.size[static_cast<std::size_t>(axis)] =
        static_cast<std::int64_t>(std::ceil((high[axis] - low[axis] + 2 * margin_mm) / spacing_mm)) + 1;
  }
  return grid;
}

std::map<std::uint8_t, Volume<float>> shares_on(const LabelVolume& labels, const Grid& grid) {
  const std::int64_t margin = std::llround(std::ceil(4 * smoothing_voxels));
  const LabelVolume near = crop(labels, box_around(labels.grid, grid, margin));
  Vec3 sigma_voxels;
  for (int axis = 0; axis < 3; ++axis)
    sigma_voxels[axis] = labels.grid.spacing_mm[axis] > coarser * grid.spacing_mm.x ? 0 : smoothing_voxels;
  std::map<std::uint8_t, Volume<float>> shares;
  Volume<float> share(near.grid);
  for (const auto value : values_of(near)) {
    for (std::size_t v = 0; v < near.voxels.size(); ++v) share.voxels[v] = near.voxels[v] == value ? 1.0F : 0.0F;
    shares.emplace(value, sampled_on(smoothed(share, sigma_voxels), grid));
  }
  return shares;
}

LabelVolume largest_share(const std::map<std::uint8_t, Volume<float>>& shares, const Grid& grid) {
  LabelVolume result(grid);
  Volume<float> largest(grid);
  for (const auto& [label, share] : shares)
    for (std::size_t v = 0; v < largest.voxels.size(); ++v) {
      if (share.voxels[v] <= largest.voxels[v]) continue;
      largest.voxels[v] = share.voxels[v];
      result.voxels[v] = label;
    }
  return result;
}

}  // namespace heartgen::image
