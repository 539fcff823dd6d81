// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// ITK's images as plain volumes. Private to the adapters.
#pragma once
#include <itkImage.h>

#include <cstdint>

#include "model/volume.hpp"

namespace heartgen::adapters {

template <class T>
using Image = itk::Image<T, 3>;

template <class ItkImage>
Grid grid_of(const ItkImage& image) {
  Grid grid;
  const auto& region = image.GetLargestPossibleRegion();
  for (unsigned axis = 0; axis < 3; ++axis) {
    grid.size[axis] = static_cast<std::int64_t>(region.GetSize()[axis]);
    grid.spacing_mm[static_cast<int>(axis)] = image.GetSpacing()[axis];
    grid.origin_mm[static_cast<int>(axis)] = image.GetOrigin()[axis];
    for (unsigned row = 0; row < 3; ++row)
      grid.direction[static_cast<int>(row)][static_cast<int>(axis)] = image.GetDirection()(row, axis);
  }
  return grid;
}

template <class T>
Volume<T> plain_volume(const Image<T>& image) {
  Volume<T> volume;
  volume.grid = grid_of(image);
  const T* data = image.GetBufferPointer();
  volume.voxels.assign(data, data + volume.grid.voxel_count());
  return volume;
}

}  // namespace heartgen::adapters
