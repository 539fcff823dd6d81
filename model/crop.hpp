// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The bounding box of what takes part, and the part of a volume inside it.
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

#include "model/volume.hpp"

namespace heartgen {

/// Voxels [begin, end) along each axis.
struct Box {
  Index3 begin{0, 0, 0}, end{0, 0, 0};
  bool empty() const { return begin[0] >= end[0] || begin[1] >= end[1] || begin[2] >= end[2]; }
};

/// Smallest box that holds every voxel for which active(value) is true, grown by `margin` voxels within the grid.
template <class T, class Active>
Box bounding_box(const Volume<T>& volume, std::int64_t margin, Active&& active) {
  const auto& size = volume.grid.size;
  Box box{size, {0, 0, 0}};
  std::size_t at = 0;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i, ++at) {
        if (!active(volume.voxels[at])) continue;
        const Index3 here{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          box.begin[axis] = std::min(box.begin[axis], here[axis]);
          box.end[axis] = std::max(box.end[axis], here[axis] + 1);
        }
      }
  if (box.empty()) return {};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.begin[axis] = std::max<std::int64_t>(box.begin[axis] - margin, 0);
    box.end[axis] = std::min(box.end[axis] + margin, size[axis]);
  }
  return box;
}

/// The part of the volume inside the box, at its place in space.
template <class T>
Volume<T> crop(const Volume<T>& volume, const Box& box) {
  Grid grid = volume.grid;
  for (std::size_t axis = 0; axis < 3; ++axis) grid.size[axis] = box.end[axis] - box.begin[axis];
  grid.origin_mm = lps_from_index(volume.grid, {static_cast<double>(box.begin[0]), static_cast<double>(box.begin[1]),
                                                static_cast<double>(box.begin[2])});
  Volume<T> result(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      std::copy_n(&volume(box.begin[0], box.begin[1] + j, box.begin[2] + k), grid.size[0], &result(0, j, k));
  return result;
}

/// Writes a cropped part back to its place.
template <class T>
void paste(const Volume<T>& part, const Box& box, Volume<T>& whole) {
  for (std::int64_t k = 0; k < part.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < part.grid.size[1]; ++j)
      std::copy_n(&part(0, j, k), part.grid.size[0], &whole(box.begin[0], box.begin[1] + j, box.begin[2] + k));
}

}  // namespace heartgen
