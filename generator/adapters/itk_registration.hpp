// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Diffeomorphic demons (thesis 9.1; Vercauteren et al., NeuroImage 45, 2009) from ITK on plain volumes.
/// Not collective. The bits of the result do not depend on the number of threads: every voxel's force, smoothing and
/// composition is computed by one thread, and the thread-ordered sums of ITK's metric are not used to stop.
#pragma once
#include <vector>

#include "model/volume.hpp"

namespace heartgen::adapters {

struct DemonsSettings {
  double sigma_mm = 2;                         ///< Gaussian smoothing of the displacement after each iteration
  std::vector<int> iterations = {60, 40, 15};  ///< per level; level l of n is coarsened by 2^(n-1-l)
  double maximum_step_voxels = 2;              ///< largest update of one iteration
  int threads = 0;                             ///< 0: ITK's default
};

/// Displacement u in mm, along x, y, z, on the grid of `fixed`, with moving(x + u(x)) close to fixed(x).
/// Both images share one grid with isotropic spacing and identity direction. Throws std::runtime_error when ITK fails.
Volume<Vec3> diffeomorphic_demons(const Volume<float>& fixed, const Volume<float>& moving,
                                  const DemonsSettings& settings);

}  // namespace heartgen::adapters
