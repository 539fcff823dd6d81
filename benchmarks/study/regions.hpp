// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The grey values and the energy of a two-phase segmentation (thesis 4.4.1, 4.4.3).
#pragma once
#include "benchmarks/study/field.hpp"

namespace heartgen::study {

enum class Norm { l1, l2 };
enum class Length { heaviside, smereka, piecewise_linear };

/// c1 where phi >= 0, c2 elsewhere.
struct GreyValues {
  double positive = 0;
  double negative = 0;
};

/// Means (4.32) or, for L1, lower medians (Proposition 71) of both sides; a side without pixels keeps its value of
/// `before`.
GreyValues grey_values(const Field& image, const Field& phi, const Domain& domain, Norm norm,
                       const GreyValues& before = {});

/// λ (-|g - c1|^p + |g - c2|^p) at every pixel: the force that pulls phi up (4.31, 4.47).
void fidelity_force(const Field& image, const GreyValues& c, Norm norm, double lambda, Field& force);

double contour_length(const Field& phi, Length length);

/// μ length + λ Σ |g - c|^p with the best c of both sides (4.30, 4.46).
double energy(const Field& image, const Field& phi, const Domain& domain, Norm norm, double mu, double lambda,
              Length length);

/// The best two classes of the grey values, wherever they lie: the problem with μ = 0 (thesis 5.2). The global optimum
/// over all thresholds. Throws UserError where all grey values are the same.
GreyValues two_means(const Field& image, const Domain& domain, Norm norm);

}  // namespace heartgen::study
