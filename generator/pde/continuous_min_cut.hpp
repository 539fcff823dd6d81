// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The continuous minimal cut between two sets: the steady state of the band problem (thesis 7.4) is the minimiser of
///   ∫ h |∇u|,  u = 1 on the inner set, u = 0 on the outer set, 0 <= u <= 1 on the free voxels between them,
/// a convex problem (Strang 1983; Appleton and Talbot 2006), solved by the preconditioned primal-dual method of Pock
/// and Chambolle (2011). The relative duality gap (primal - dual) / primal certifies how far from the optimum the
/// result can be. The cut is the 1/2 level of u. Any spacing, homogeneous Neumann at the border of the image, float32,
/// the same bits for any number of ranks and threads.
#pragma once
#include <cstdint>

#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

/// What a voxel of the state mask is.
enum CutState : std::uint8_t { cut_outer = 0, cut_free = 1, cut_inner = 2 };

struct MinimalCutSettings {
  int max_iterations = 600;
  double duality_gap = 1e-3;  ///< relative; stops below it
  int check_interval = 20;    ///< iterations between two evaluations of the gap
};

struct MinimalCutResult {
  parallel::Slab<float> u;  ///< 1 on the inner set, 0 on the outer one
  double duality_gap = 0;   ///< relative
  double energy = 0;        ///< ∫ h |∇u| in units of h times mm²
  int iterations = 0;
};

/// `weight` is h > 0, needed on free voxels and their neighbours. Both slabs have one ghost slice at least, filled.
/// Voxels that are not free (nor neighbours of one) cost next to nothing. Throws UserError for a state mask without
/// inner, outer or free voxels, or a weight that is not positive and finite on a free voxel. @collective
MinimalCutResult continuous_min_cut(const parallel::Slab<float>& weight, const parallel::Slab<std::uint8_t>& state,
                                    const MinimalCutSettings& settings, const parallel::Comm& comm);

struct MinimalCutVolume {
  Volume<float> u;  ///< on the root only
  double duality_gap = 0;
  double energy = 0;
  int iterations = 0;
};

/// The same for whole volumes on the root (both on the same grid), restricted to the bounding box of the free voxels.
/// Gap, energy and iterations are known on every rank. @collective
MinimalCutVolume continuous_min_cut(const Volume<float>& weight_on_root, const Mask& state_on_root,
                                    const MinimalCutSettings& settings, const parallel::Comm& comm);

}  // namespace heartgen::pde
