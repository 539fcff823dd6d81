#include "generator/atlas/resample.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generator/parallel/threads.hpp"
#include "model/corners.hpp"

namespace heart::atlas {
namespace {

/// The label with the largest share of the eight voxels around a point, each weighted as in linear interpolation.
std::uint8_t label_at(const LabelVolume& labels, const Vec3& lps_mm) {
  std::array<std::uint8_t, 8> label{};
  std::array<double, 8> share{};
  std::size_t count = 0;
  const Vec3 index = index_from_lps(labels.grid, lps_mm);
  for_corners(index, [&](double weight, std::int64_t i, std::int64_t j, std::int64_t k) {
    const auto value = labels.grid.contains(i, j, k) ? labels(i, j, k) : std::uint8_t{0};
    const auto slot = static_cast<std::size_t>(std::find(label.begin(), label.begin() + count, value) - label.begin());
    if (slot == count) label[count++] = value;
    share[slot] += weight;
  });
  return label[static_cast<std::size_t>(std::max_element(share.begin(), share.begin() + count) - share.begin())];
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

LabelVolume resampled(const LabelVolume& labels, const Grid& grid) {
  LabelVolume result(grid);
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i)
          result(i, j, k) = label_at(
              labels, lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
  });
  return result;
}

}  // namespace heart::atlas
