// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The thesis's own way to a Chan-Vese contour: a level set function φ flows by
///   φ_t = |∇φ| (mu div(∇φ / |∇φ|) + lambda (|g - c_below|^p - |g - c_above|^p) / |c_above - c_below|^p)
/// (thesis 4.38, p = 2, and 4.47, p = 1, with |∇φ| for the delta function), discretised by the semi-explicit scheme of
/// thesis (3.11) and (3.14), method 3 of 5.1.2, in 2D and 3D: a voxel's new value takes its neighbours' old ones and is
/// divided by 1 + time_step |∇φ| Σ c. c is taken anew from the two sides as the contour moves (6.1: exact medians).
///
/// It stops in local minima, and needs many more sweeps than the convex form (chan_vese.hpp), which segments for
/// production; this is the reference to compare with, and the measure of what a sweep costs. Units, norms and the
/// division by the contrast are those of chan_vese.hpp; homogeneous Neumann conditions at the border of the domain, any
/// spacing, float32, the same bits for any number of ranks and threads and any vector length.
#pragma once
#include <cstdint>

#include "generator/parallel/slab.hpp"
#include "generator/pde/chan_vese.hpp"

namespace heartgen::pde {

struct ChanVeseFlowSettings {
  Norm norm = Norm::l1;
  double lambda = 1;          ///< weight of the fidelity
  double mu = 0.1;            ///< weight of the contour's area, mm (at lambda = 1)
  double time_step = 0.1;     ///< times lambda, in smallest spacings that the contour may move: at most 1
  int max_iterations = 1000;  ///< sweeps at most
  int check_interval = 20;    ///< sweeps between two updates of c; stops when no voxel changed sides at two of them
  bool fixed_values = false;  ///< keep c_below and c_above of the start (the best two classes, or those given)
};

struct ChanVeseFlowResult {
  parallel::Slab<float> phi;           ///< positive above; no distance, in multiples of its start
  parallel::Slab<std::uint8_t> above;  ///< 1 on the side with the higher grey value, else 0 (also outside the domain)
  double c_below = 0;                  ///< median (L1) or mean (L2) of each side
  double c_above = 0;
  int iterations = 0;      ///< sweeps done
  bool converged = false;  ///< no voxel changed sides any more
  double energy = 0;       ///< chan_vese_energy of the result, mm³
};

/// From the best two classes of the grey values: φ = ±1 by the threshold between them (thesis 5.2). Both slabs have one
/// ghost slice at least, filled. Throws UserError as chan_vese does, and for a time step outside (0, 1]. @collective
ChanVeseFlowResult chan_vese_flow(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain,
                                  const ChanVeseFlowSettings& settings, const parallel::Comm& comm);

/// From any φ (one ghost slice at least) and grey values, c_below < c_above. @collective
ChanVeseFlowResult chan_vese_flow(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain,
                                  parallel::Slab<float> phi, double c_below, double c_above,
                                  const ChanVeseFlowSettings& settings, const parallel::Comm& comm);

/// `sweeps` sweeps at fixed grey values and nothing else. @collective
void sweep_flow(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain,
                parallel::Slab<float>& phi, double c_below, double c_above, const ChanVeseFlowSettings& settings,
                int sweeps, const parallel::Comm& comm);

}  // namespace heartgen::pde
