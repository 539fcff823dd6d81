// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/anatomy/padding.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/priors.hpp"
#include "model/sort_unique.hpp"
#include "model/tissue.hpp"

namespace heartgen::anatomy {
namespace {

constexpr std::int64_t min_voxels = 2;

/// An image as columns along one axis: column (i, j) of the plane, slice by slice.
struct Columns {
  std::array<std::int64_t, 2> size;    // of the plane
  std::array<std::int64_t, 2> stride;  // in voxels
  std::array<double, 2> spacing_mm;
  std::int64_t slices, slice_stride;
  double slice_mm;

  std::int64_t count() const { return size[0] * size[1]; }
  std::size_t voxel(std::int64_t column, std::int64_t slice) const {
    return static_cast<std::size_t>(column % size[0] * stride[0] + column / size[0] * stride[1] + slice * slice_stride);
  }
};

Columns columns_along(const Grid& grid, std::size_t axis) {
  const std::array<std::int64_t, 3> stride{1, grid.size[0], grid.size[0] * grid.size[1]};
  const std::size_t first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  return {{grid.size[first], grid.size[second]},
          {stride[first], stride[second]},
          {grid.spacing_mm[static_cast<int>(first)], grid.spacing_mm[static_cast<int>(second)]},
          grid.size[axis],
          stride[axis],
          grid.spacing_mm[static_cast<int>(axis)]};
}

std::int64_t reach_of(double spacing_mm) {
  return std::max<std::int64_t>(min_voxels, std::llround(priors::padding_wall_mm / spacing_mm));
}

/// Where an image holds nothing but one value.
struct Even {
  std::vector<std::uint8_t> column, slice;  // 1: all of it, but for what lies in slices that are empty anyway
};

Even find_even(const CtVolume& ct, const Columns& columns, std::int16_t value) {
  Even even{std::vector<std::uint8_t>(static_cast<std::size_t>(columns.count()), 1),
            std::vector<std::uint8_t>(static_cast<std::size_t>(columns.slices), 1)};
  for (std::int64_t slice = 0; slice < columns.slices; ++slice)
    for (std::int64_t c = 0; c < columns.count(); ++c)
      if (ct.voxels[columns.voxel(c, slice)] != value)
        even.column[static_cast<std::size_t>(c)] = even.slice[static_cast<std::size_t>(slice)] = 0;
  return even;
}

/// Measured columns beside those of the padding.
std::vector<std::int64_t> rim_of(const Columns& columns, const std::vector<std::uint8_t>& even) {
  std::vector<std::int64_t> rim;
  for (std::int64_t c = 0; c < columns.count(); ++c) {
    if (even[static_cast<std::size_t>(c)] != 0) continue;
    const std::int64_t i = c % columns.size[0], j = c / columns.size[0];
    const auto is_even = [&](std::int64_t di, std::int64_t dj) {
      const std::int64_t ni = i + di, nj = j + dj;
      return ni >= 0 && ni < columns.size[0] && nj >= 0 && nj < columns.size[1] &&
             even[static_cast<std::size_t>(ni + nj * columns.size[0])] != 0;
    };
    if (is_even(-1, 0) || is_even(1, 0) || is_even(0, -1) || is_even(0, 1)) rim.push_back(c);
  }
  return rim;
}

/// What lies at the border of the padding.
struct Border {
  std::int64_t lung = 0, even = 0, all = 0;
  void add(int hu, int value) {
    lung += hu > tissue::padding_lung_min_hu && hu < tissue::padding_lung_max_hu && hu != value;
    even += hu == value;
    ++all;
  }
  /// Whether lungs end there, as a field of view cuts them. Around a body that was cut out of its air the border is
  /// that of all slices together, and most of it is empty.
  bool cuts_lungs() const {
    constexpr double min_lung = 0.03, max_even = 0.5;
    return static_cast<double>(lung) > min_lung * static_cast<double>(all) &&
           static_cast<double>(even) < max_even * static_cast<double>(all);
  }
};

/// The columns of the padding that are near the rim.
std::vector<std::int64_t> wall_around(const Columns& columns, const std::vector<std::uint8_t>& even,
                                      const std::vector<std::int64_t>& rim) {
  const std::array reach{reach_of(columns.spacing_mm[0]), reach_of(columns.spacing_mm[1])};
  std::vector<std::int64_t> wall;
  for (const auto c : rim)
    for (auto j = -reach[1]; j <= reach[1]; ++j)
      for (auto i = -reach[0]; i <= reach[0]; ++i) {
        const std::int64_t ni = c % columns.size[0] + i, nj = c / columns.size[0] + j;
        if (ni < 0 || ni >= columns.size[0] || nj < 0 || nj >= columns.size[1]) continue;
        const auto near = ni + nj * columns.size[0];
        if (even[static_cast<std::size_t>(near)] != 0) wall.push_back(near);
      }
  sort_unique(wall);
  return wall;
}

void find_wall(const CtVolume& ct, const Columns& columns, const Even& even, Padding& padding) {
  const auto rim = rim_of(columns, even.column);
  Border border;
  for (std::int64_t slice = 0; slice < columns.slices; ++slice)
    if (even.slice[static_cast<std::size_t>(slice)] == 0)
      for (const auto c : rim) border.add(ct.voxels[columns.voxel(c, slice)], padding.value_hu);
  if (!border.cuts_lungs()) return;
  padding.is_column = even.column;
  padding.wall = wall_around(columns, even.column, rim);
}

void find_lids(const CtVolume& ct, const Columns& columns, const Even& even, Padding& padding) {
  const auto is_even = [&](std::int64_t slice) {
    return slice >= 0 && slice < columns.slices && even.slice[static_cast<std::size_t>(slice)] != 0;
  };
  const auto reach = reach_of(columns.slice_mm);
  for (std::int64_t slice = 0; slice < columns.slices; ++slice)
    for (const std::int64_t way : {-1, 1}) {
      if (is_even(slice) || !is_even(slice + way)) continue;
      Border border;
      for (std::int64_t c = 0; c < columns.count(); ++c)
        if (even.column[static_cast<std::size_t>(c)] == 0)
          border.add(ct.voxels[columns.voxel(c, slice)], padding.value_hu);
      if (!border.cuts_lungs()) continue;
      padding.is_slice = even.slice;
      for (std::int64_t n = 1; n <= reach && is_even(slice + n * way); ++n) padding.lids.push_back(slice + n * way);
    }
}

Padding padding_along(const CtVolume& ct, std::size_t axis, std::int16_t value) {
  const auto columns = columns_along(ct.grid, axis);
  const auto even = find_even(ct, columns, value);
  Padding padding;
  padding.value_hu = value;
  padding.axis = axis;
  padding.width = columns.size[0];
  find_wall(ct, columns, even, padding);
  find_lids(ct, columns, even, padding);
  if (padding.wall.empty() && padding.lids.empty()) return {};
  padding.is_column.resize(even.column.size(), 0);
  padding.is_slice.resize(even.slice.size(), 0);
  return padding;
}

void fill_wall_and_lids(CtVolume& ct, const Padding& padding, std::int16_t hu) {
  if (!padding.is_there()) return;
  const auto columns = columns_along(ct.grid, padding.axis);
  for (std::int64_t slice = 0; slice < columns.slices; ++slice)
    if (padding.is_slice[static_cast<std::size_t>(slice)] == 0)
      for (const auto c : padding.wall) ct.voxels[columns.voxel(c, slice)] = hu;
  for (const auto lid : padding.lids) {
    for (std::int64_t c = 0; c < columns.count(); ++c)
      if (padding.is_column[static_cast<std::size_t>(c)] == 0) ct.voxels[columns.voxel(c, lid)] = hu;
    for (const auto c : padding.wall) ct.voxels[columns.voxel(c, lid)] = hu;
  }
}

}  // namespace

Padding find_padding(const CtVolume& ct) {
  if (ct.voxels.empty()) return {};
  for (const auto value : {ct.voxels.front(), ct.voxels.back()})
    for (const std::size_t axis : {2U, 1U, 0U}) {
      if (value > tissue::padding_max_hu) continue;
      if (auto padding = padding_along(ct, axis, value); padding.is_there()) return padding;
    }
  return {};
}

void close_padding(CtVolume& ct, const Padding& padding) {
  const auto fat_hu = static_cast<std::int16_t>(tissue::padding_fat_hu);
  const auto darkest_hu = static_cast<std::int16_t>(tissue::scale_floor_hu);
  for (auto& hu : ct.voxels) hu = std::max(hu, darkest_hu);
  fill_wall_and_lids(ct, padding, fat_hu);
}

void reopen_padding(CtVolume& ct, const Padding& padding) { fill_wall_and_lids(ct, padding, padding.value_hu); }

void clear_padding(LabelVolume& labels, const Padding& padding) {
  if (!padding.is_there() || labels.voxels.empty()) return;
  std::size_t v = 0;
  const auto& size = labels.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++v)
        if (padding.covers({i, j, k})) labels.voxels[v] = 0;
}

}  // namespace heartgen::anatomy
