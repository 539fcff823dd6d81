#include "generator/segment/padding.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/sort_unique.hpp"

namespace heart::segment {
namespace {

constexpr int most_hu = -500;

/// An image as columns along one axis: column (i, j) of the plane, slice by slice.
struct Columns {
  std::array<std::int64_t, 2> size;    // of the plane
  std::array<std::int64_t, 2> stride;  // in voxels
  std::array<double, 2> spacing_mm;
  std::int64_t slices, slice_stride;

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
          stride[axis]};
}

std::vector<std::int64_t> slices_with_more(const CtVolume& ct, const Columns& columns) {
  std::vector<std::int64_t> found;
  for (std::int64_t slice = 0; slice < columns.slices; ++slice)
    for (std::int64_t c = 0; c < columns.count(); ++c)
      if (ct.voxels[columns.voxel(c, slice)] != ct.voxels.front()) {
        found.push_back(slice);
        break;
      }
  return found;
}

/// 1 for the columns that hold the first voxel's value only.
std::vector<std::uint8_t> even_columns(const CtVolume& ct, const Columns& columns,
                                       const std::vector<std::int64_t>& slices) {
  std::vector<std::uint8_t> even(static_cast<std::size_t>(columns.count()), 1);
  for (const auto slice : slices)
    for (std::int64_t c = 0; c < columns.count(); ++c)
      if (ct.voxels[columns.voxel(c, slice)] != ct.voxels.front()) even[static_cast<std::size_t>(c)] = 0;
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

/// Whether lungs end at the rim, as a field of view cuts them. Around a body that was cut out of its air the rim is
/// that of all slices together, and most of it is empty.
bool cuts_lungs(const CtVolume& ct, const Columns& columns, const std::vector<std::int64_t>& rim,
                const std::vector<std::int64_t>& slices) {
  constexpr int least_lung_hu = -980, most_lung_hu = -600;
  constexpr double least_lung = 0.03, most_even = 0.5;
  std::int64_t lung = 0, even = 0;
  for (const auto slice : slices)
    for (const auto c : rim) {
      const int hu = ct.voxels[columns.voxel(c, slice)];
      lung += hu > least_lung_hu && hu < most_lung_hu && hu != ct.voxels.front();
      even += hu == ct.voxels.front();
    }
  const auto all = static_cast<double>(rim.size() * slices.size());
  return static_cast<double>(lung) > least_lung * all && static_cast<double>(even) < most_even * all;
}

/// The columns of the padding that are near the rim.
std::vector<std::int64_t> wall_around(const Columns& columns, const std::vector<std::uint8_t>& even,
                                      const std::vector<std::int64_t>& rim) {
  constexpr double thickness_mm = 6;
  constexpr std::int64_t least_voxels = 2;
  std::array<std::int64_t, 2> reach{};
  for (std::size_t a = 0; a < 2; ++a)
    reach[a] = std::max<std::int64_t>(least_voxels, std::llround(thickness_mm / columns.spacing_mm[a]));
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

void fill_wall(CtVolume& ct, const Padding& padding, std::int16_t hu) {
  if (!padding.is_there()) return;
  const auto columns = columns_along(ct.grid, padding.axis);
  for (std::int64_t slice = 0; slice < columns.slices; ++slice)
    for (const auto c : padding.wall) ct.voxels[columns.voxel(c, slice)] = hu;
}

}  // namespace

Padding find_padding(const CtVolume& ct) {
  if (ct.voxels.empty() || ct.voxels.front() > most_hu) return {};
  for (const std::size_t axis : {2U, 1U, 0U}) {
    const auto columns = columns_along(ct.grid, axis);
    const auto slices = slices_with_more(ct, columns);
    const auto even = even_columns(ct, columns, slices);
    const auto rim = rim_of(columns, even);
    if (!rim.empty() && cuts_lungs(ct, columns, rim, slices))
      return {ct.voxels.front(), axis, columns.size[0], even, wall_around(columns, even, rim)};
  }
  return {};
}

void close_padding(CtVolume& ct, const Padding& padding) {
  constexpr std::int16_t fat_hu = -80;
  fill_wall(ct, padding, fat_hu);
}

void reopen_padding(CtVolume& ct, const Padding& padding) { fill_wall(ct, padding, padding.value_hu); }

void clear_padding(LabelVolume& labels, const Padding& padding) {
  if (!padding.is_there()) return;
  const auto columns = columns_along(labels.grid, padding.axis);
  for (std::int64_t slice = 0; slice < columns.slices; ++slice)
    for (std::int64_t c = 0; c < columns.count(); ++c)
      if (padding.is_padded[static_cast<std::size_t>(c)] != 0) labels.voxels[columns.voxel(c, slice)] = 0;
}

}  // namespace heart::segment
