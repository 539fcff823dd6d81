// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Total variation denoising (thesis 3.4): with L2 fidelity (Rudin, Osher and Fatemi 1992), with L1 fidelity (Chan and
/// Esedoglu 2005), and the form of Marquina and Osher (2000).
/// The two convex problems are solved by the primal-dual method of Chambolle and Pock (2011), the third by curvature
/// motion with a pull to the image (curvature.hpp). Homogeneous Neumann conditions, any spacing, float32, the same bits
/// for any number of ranks and threads.
#pragma once
#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

struct TotalVariationSettings {
  double lambda = 0.05;  ///< L2: per mm and grey value; L1: per mm. Larger keeps more detail
  int iterations = 100;
};

/// Minimises ∫ |∇u| + lambda ∫ (u - g)². In place; one ghost slice at least. Throws UserError unless lambda > 0 and
/// iterations >= 0. @collective
void total_variation_l2(parallel::Slab<float>& image, const TotalVariationSettings& settings,
                        const parallel::Comm& comm);

/// Minimises ∫ |∇u| + lambda ∫ |u - g|: a ball of radius r (mm) stays when lambda > 3 / r in 3D (2 / r for a disc in
/// 2D), whatever its contrast, and vanishes below. As above. @collective
void total_variation_l1(parallel::Slab<float>& image, const TotalVariationSettings& settings,
                        const parallel::Comm& comm);

struct MarquinaOsherSettings {
  double lambda = 0.05;  ///< per mm and grey value
  int iterations = 20;
  double time_step = 0.1;  ///< in units of the smallest squared spacing; accurate up to 1/8, stable for any
};

/// u_t = |∇u| (div(∇u / |∇u|) + lambda (g - u)): no staircases (3.15). As above. @collective
void marquina_osher(parallel::Slab<float>& image, const MarquinaOsherSettings& settings, const parallel::Comm& comm);

/// ∫ |∇u| (forward differences, isotropic) in grey values times mm²; mm for a single slice. @collective
double total_variation(const parallel::Slab<float>& image, const parallel::Comm& comm);

}  // namespace heartgen::pde
