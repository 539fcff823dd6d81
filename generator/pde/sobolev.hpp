// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Sobolev smoothing (thesis 3.3): the minimiser of ∫ length² |∇u|² + (u - g)², that is (I - length² Δ) u = g with
/// homogeneous Neumann conditions. Solved by Chebyshev's semi-iteration (Golub and Varga 1961), which needs no inner
/// products: the spectrum of the operator is known, [1, 1 + 4 length² Σ 1/h²].
#pragma once
#include "generator/parallel/slab.hpp"

namespace heartgen::pde {

struct SobolevSettings {
  double smoothing_mm = 1;  ///< details smaller than this are smoothed; 1 in the thesis (pixels)
  double tolerance = 1e-4;  ///< bound of the remaining error, relative to the error of u = g
};

/// In place; the slab has one ghost slice at least. Throws UserError for a negative length or a tolerance outside
/// (0, 1). @collective
void sobolev(parallel::Slab<float>& image, const SobolevSettings& settings, const parallel::Comm& comm);

}  // namespace heartgen::pde
