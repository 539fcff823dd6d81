// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the last step of a two-phase segmentation, voxel by voxel.
#pragma once
#include <cstdint>

#include "generator/parallel/slab.hpp"
#include "generator/pde/row_kernels.hpp"
#include "generator/pde/row_runs.hpp"

namespace heartgen::pde {

/// Changes the side of single voxels as long as that lowers  Σ |w ∇above| - <s, above>  on the domain (isotropic
/// forward differences; s = force.gain (g - force.middle) within ± force.limit), at most `passes` times over the voxels
/// of `visited`. The 1/2 level of the relaxed problem's solution minimises that sum up to what the discrete TV of a
/// jump differs from that of a slope; this takes the rest. Voxels that share no term go together: four classes, in a
/// fixed order. `above` has one ghost slice, filled. @collective
void descend_coordinates(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain,
                         const LinearForce& force, const AxisWeights& weights, const RowRuns& visited, int passes,
                         parallel::Slab<std::uint8_t>& above, const parallel::Comm& comm);

}  // namespace heartgen::pde
