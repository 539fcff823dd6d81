// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: voxels of a two-phase problem whose side is known before it is solved.
///
/// For  min over 0 <= u <= 1 of  TV(u) - <s, u>  with the forward-difference TV of row_kernels.hpp, a minimiser with
/// u < 1 at a voxel satisfies s <= -div p there, and p, a unit vector per voxel that follows ∇u, bounds the right side:
/// lower neighbours contribute at most their weight, and nothing above zero once they are known to be 1; the voxel's
/// own vector contributes at most the norm of the weights towards upper neighbours not known to be 1 and, when all are
/// known to be, minus the norm of all of them. Where s is larger than that bound, u = 1 in every minimiser; the
/// mirrored test gives u = 0. Deciding voxels decides more of them: the test is repeated. Sound, so the minimum stays
/// the same.
#pragma once
#include <cstdint>

#include "generator/parallel/slab.hpp"
#include "generator/pde/row_kernels.hpp"

namespace heartgen::pde {

enum Decision : std::uint8_t { decided_outside = 0, undecided = 1, decided_below = 2, decided_above = 3 };

/// The decisions for the force s = gain (g - middle) within ± limit, that of `primal_row_force` at step 1; rounds go on
/// as long as they decide much. The result has one ghost slice, filled. @collective
parallel::Slab<std::uint8_t> screen(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain,
                                    const LinearForce& force, const AxisWeights& weights, const parallel::Comm& comm);

}  // namespace heartgen::pde
