// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Reinitialisation of a level set to the signed distance (thesis 8.3, 8.6, 8.7): φ_t = S(φ0) (1 - |∇φ|) with Godunov's
/// upwind gradient. Negative inside; mm. Distances spread by half a voxel (smallest spacing) per iteration.
/// The plain scheme moves the zero level; here the voxels beside it get their distance from the first-order formula
/// φ0 / |∇φ0| and keep it (Russo and Smereka 2000), so the smoothed sign of thesis 8.4 and 8.5 is not needed.
#pragma once
#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

struct RedistanceSettings {
  int iterations = 40;
};

/// In place; the slab has one ghost slice at least. Throws UserError for a negative number of iterations. @collective
void redistance(parallel::Slab<float>& level_set, const RedistanceSettings& settings, const parallel::Comm& comm);

}  // namespace heartgen::pde
