// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The reference: the two-phase Chan-Vese problem by its convex form (Chan, Esedoglu and Nikolova 2006; thesis 4.40),
///   min over 0 <= u <= 1 of  μ Σ |∇+ u| + λ Σ (|g - c1|^p - |g - c2|^p) u,
/// solved by the primal-dual method of Chambolle and Pock (2011) until its duality gap is small, c1 and c2 taken anew
/// from the level 1/2 in between. For given c this is the global minimum of the energy with the Heaviside length, up to
/// the gap; over c it is the best of the starts that are tried.
#pragma once
#include "benchmarks/study/regions.hpp"

namespace heartgen::study {

struct GlobalSettings {
  Norm norm = Norm::l2;
  double mu = 2;
  double lambda = 0.00004;
  double relative_gap = 1e-3;  ///< of the energy, at which the solver for fixed c stops
  int max_iterations = 5000;   ///< of the solver for fixed c
  int max_updates = 30;        ///< of c
};

struct GlobalMinimum {
  Field phi;  ///< u - 1/2
  GreyValues c;
  double energy = 0;        ///< with the Heaviside length
  double relative_gap = 0;  ///< of the last solve
  int iterations = 0;       ///< over all solves
};

/// From the two best classes of the grey values. Throws UserError as `two_means` does.
GlobalMinimum global_minimum(const Field& image, const Domain& domain, const GlobalSettings& settings);

/// From given grey values.
GlobalMinimum global_minimum(const Field& image, const Domain& domain, const GlobalSettings& settings,
                             const GreyValues& start);

}  // namespace heartgen::study
