// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Connected components of masks (6-neighbours, sharing a face). Labels are numbered by the first voxel in memory
/// order, so that the result is the same everywhere. Thesis 6.2: the component of a seed.
#pragma once
#include <cstdint>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::image {

struct Components {
  Volume<std::int32_t> label;             ///< 0 outside the mask, 1..N inside
  std::vector<std::int64_t> voxel_count;  ///< per label; [0] counts the voxels outside the mask
};

Components connected_components(const Mask& mask);

/// The component that holds the voxel `seed`. Empty where the seed is not in the mask, or where the component has
/// more than `limit` voxels (a leak).
Mask component_of(const Mask& mask, const Index3& seed, std::int64_t limit = INT64_MAX);

/// The component with most voxels (the first of equals); empty for an empty mask.
Mask largest_component(const Mask& mask);

/// Keeps components of at least `minimum` voxels.
Mask drop_small_components(const Mask& mask, std::int64_t minimum);

/// Sets the unset voxels that are not connected to the border of the grid.
Mask fill_holes(const Mask& mask);

/// The same slice by slice (constant k): holes that are closed in the slice only.
Mask fill_holes_in_slices(const Mask& mask);

}  // namespace heartgen::image
