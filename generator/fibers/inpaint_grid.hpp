// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Total variation inpainting of axes (inpaint.hpp) on the voxels of an image that is divided among ranks: the same
/// steps in the same order, so the same bits as on the graph of the voxels' faces, for any number of ranks and threads.
#pragma once
#include <cstdint>

#include "generator/parallel/slab.hpp"
#include "model/axis_tensor.hpp"

namespace heartgen::fibers {

/// What a voxel is to inpainting: nothing flows to the voxels outside the wall.
enum class AxisKind : std::uint8_t { outside = 0, known = 1, missing = 2 };

/// Replaces the tensors of missing voxels by dyads of unit axes and makes them known; those that no known voxel can be
/// reached from stay missing. `kinds`: values of AxisKind. Both slabs of one grid with one ghost slice, whose values
/// need not be set. Returns the number of voxels filled, over all ranks. @collective
std::int64_t inpaint_axes(parallel::Slab<AxisTensor>& axes, parallel::Slab<std::uint8_t>& kinds, int iterations,
                          const parallel::Comm& comm);

/// The same of a whole image: `fiber` on the root, unit axes or zero; where it is zero and `wall` is not, it is filled.
/// Returns the filled image on the root, an empty one elsewhere. @collective
Volume<Vec3> inpaint_axes(const Volume<Vec3>& fiber, const Mask& wall, int iterations, const parallel::Comm& comm);

}  // namespace heartgen::fibers
