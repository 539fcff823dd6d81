// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Two-phase Chan-Vese segmentation of a masked domain (thesis 4.4, 5.2, 5.4), L1 (medians) or L2 (means), in its
/// convex form (Chan, Esedoglu and Nikolova 2006): for fixed grey values c the contour is the 1/2 level of
///   min over 0 <= u <= 1 of  mu TV(u) + lambda ∫ (|g - c_above|^p - |g - c_below|^p) / |c_above - c_below|^p u,
/// solved by the primal-dual method of Chambolle and Pock (2011) on the domain's voxels, with homogeneous Neumann
/// conditions at its border; c is taken anew from the two sides after every few sweeps.
///
/// The fidelity is divided by the contrast |c_above - c_below|^p: it lies in [-1, 1] (L1) whatever the grey scale, so
/// the same lambda and mu work at any contrast. mu is a length in mm when lambda is 1: balls with radii below
/// 3 mu / lambda vanish (discs of a single slice below 2 mu / lambda). For fixed c the relaxed problem is solved to its
/// global minimum; over c the result is a fixed point, reached from the best two classes of the histogram. mu = 0 is
/// thresholding at those, done without iterations.
///
/// Most voxels are decided before the first sweep, by their grey value and their neighbours' (safe_screening.hpp,
/// exact); the sweeps visit the others only. At the end single voxels change sides where that lowers the energy
/// (coordinate_descent.hpp).
///
/// What mu weighs: TV by isotropic forward differences, which measures too much where edges are sharp. Where the
/// relaxed field goes from 0 to 1 over two to four voxels: 3 to 5 % for a ball, -1 to 11 % for planes of any direction.
/// On a division into voxels (chan_vese_energy): 27 % for a ball, 16 % for a disc in 2D, 3 to 46 % for planes. So the
/// effective mu is larger by that much, and such energies can be compared with each other only.
///
/// The image must be finite. float32, any spacing, the same bits for any number of ranks and threads.
#pragma once
#include <cstdint>

#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

enum class Norm { l1, l2 };

struct ChanVeseSettings {
  Norm norm = Norm::l1;
  double lambda = 1;         ///< weight of the fidelity
  double mu = 0.1;           ///< weight of the contour's area, mm (at lambda = 1)
  int max_iterations = 100;  ///< sweeps at most
  int check_interval = 10;   ///< sweeps between two updates of c; stops when no voxel changed sides at two of them
};

struct ChanVeseResult {
  parallel::Slab<std::uint8_t> above;  ///< 1 on the side with the higher grey value, else 0 (also outside the domain)
  double c_below = 0;                  ///< median (L1) or mean (L2) of each side
  double c_above = 0;
  int iterations = 0;      ///< sweeps done
  bool converged = false;  ///< no voxel changed sides any more
  double energy = 0;       ///< mu area + lambda fidelity of the result, mm³
};

/// `domain` is 1 where the image takes part. Both slabs have one ghost slice at least, filled.
/// A domain with one grey value only has no contour: `above` is empty and c_below == c_above.
/// Throws UserError for an empty domain, lambda <= 0 or mu < 0. @collective
ChanVeseResult chan_vese(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain,
                         const ChanVeseSettings& settings, const parallel::Comm& comm);

/// The same at given grey values, c_below < c_above, which it keeps. @collective
ChanVeseResult chan_vese_at(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain,
                            double c_below, double c_above, const ChanVeseSettings& settings,
                            const parallel::Comm& comm);

/// The energy of any division of the domain at given grey values. @collective
double chan_vese_energy(const parallel::Slab<float>& image, const parallel::Slab<std::uint8_t>& domain,
                        const parallel::Slab<std::uint8_t>& above, double c_below, double c_above,
                        const ChanVeseSettings& settings, const parallel::Comm& comm);

struct ChanVeseMasks {
  Mask above;  ///< on the root only
  double c_below = 0, c_above = 0;
  int iterations = 0;
  bool converged = false;
  double energy = 0;
};

/// The same for whole volumes on the root (both on the same grid), restricted to the bounding box of the domain.
/// Grey values, iterations and energy are known on every rank. @collective
ChanVeseMasks chan_vese(const Volume<float>& image_on_root, const Mask& domain_on_root,
                        const ChanVeseSettings& settings, const parallel::Comm& comm);

}  // namespace heartgen::pde
