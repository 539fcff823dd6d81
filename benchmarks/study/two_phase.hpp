// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The seven discretisations of the two-phase Chan-Vese flow (thesis 5.1.2),
///   phi_t = δ(phi) [ μ div(∇phi / |∇phi|) - λ |g - c1|^p + λ |g - c2|^p ]      (5.7; 4.47 for p = 1),
/// with c1, c2 taken anew at every step, from any start, on any part of the plane. Explicit in time but for the schemes
/// that say otherwise.
#pragma once
#include <functional>
#include <span>
#include <string>

#include "benchmarks/study/regions.hpp"
#include "benchmarks/study/schemes.hpp"

namespace heartgen::study {

enum class Discretisation {
  central = 1,        ///< δ replaced by |∇phi| (4.38), curvature by central differences (3.10)
  midpoint,           ///< δ replaced by |∇phi|, curvature at midpoints (3.12)
  semi_explicit,      ///< δ replaced by |∇phi|, the pixel's own value taken at the new time (3.14)
  global,             ///< no δ, phi kept in [-1, 1] (4.42): a convex problem for given c
  regularised_delta,  ///< δ_β (5.8) times curvature at midpoints (3.12)
  heaviside_energy,   ///< gradient of the discrete energy with length (5.9), as printed in (5.14) and (5.15)
  delta_energy,       ///< gradient of the discrete energy with length (5.16), as printed in (5.21)
};
inline constexpr int discretisation_count = 7;
/// In words, "1 |∇φ|, central (3.10)" and so on.
std::string name_of(Discretisation method);

struct FlowSettings {
  Discretisation method = Discretisation::semi_explicit;
  Norm norm = Norm::l2;
  double mu = 2;
  double lambda = 0.00004;
  double beta = 5;  ///< width of δ_β (methods 5, 6, 7), in units of phi
  double time_step = 0.1;
  int max_iterations = 20000;
  int calm_iterations = 500;  ///< steady when no pixel changed sides during so many iterations
};

struct FlowResult {
  Field phi;
  GreyValues c;
  int iterations = 0;   ///< done
  int last_change = 0;  ///< the last iteration in which a pixel changed sides
  bool steady = false;
};

/// Called after every iteration with its number and the sides; return false to stop.
using Watch = std::function<bool(int iteration, const Field& phi)>;

/// Throws UserError for λ <= 0, μ < 0, or a time step or β that is not positive.
FlowResult chan_vese_flow(const Field& image, Field phi, const Domain& domain, const FlowSettings& settings,
                          const Watch& watch = {});

}  // namespace heartgen::study
