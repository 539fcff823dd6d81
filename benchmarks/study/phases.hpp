// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Segmentation into more than two phases: two level sets at once (thesis 4.34 to 4.36), several levels of one level
/// set (4.37), and one two-phase problem after another (5.3). L2 fidelity.
#pragma once
#include <array>

#include "benchmarks/study/field.hpp"
#include "benchmarks/study/two_phase.hpp"

namespace heartgen::study {

struct PhaseSettings {
  double mu = 1;
  double lambda = 1;
  double time_step = 0.1;
  int max_iterations = 5000;
  int calm_iterations = 200;  ///< steady when no pixel changed its class during so many
};

struct PhaseResult {
  PixelLabels classes;    ///< 0, 1, ... from the darkest grey value to the brightest
  std::vector<double> c;  ///< their means, rising
  PixelLabels contours;   ///< bit 0: {phi_1 >= 0}, bit 1: {phi_2 >= 0} (or the two levels)
  int iterations = 0;
  bool steady = false;
};

/// Two level sets, four phases, started from the four best grey classes found by halving the two best (the start of 5.2
/// applied twice). Semi-explicit with |∇phi| for δ (3.14, 4.38).
PhaseResult four_phases(const Field& image, const PhaseSettings& settings);

/// The levels 0 and 1 of one level set, three phases, started from the two best classes, of which the one that spreads
/// more is halved again. δ_β with β = 1/4 of the distance of the levels, semi-explicit.
PhaseResult three_layers(const Field& image, const PhaseSettings& settings);

/// Two phases, then each of them in two, each with its own μ: first, darker side, brighter side. Method 3.
PhaseResult hierarchical_phases(const Field& image, const PhaseSettings& settings, const std::array<double, 3>& mu);

struct Misclassified {
  std::int64_t wrong = 0;    ///< pixels whose class is not the true one
  std::int64_t foreign = 0;  ///< of these, pixels without a true pixel of their class within `reach`: not a rounded
                             ///< corner or a shifted border, but a class that has no business there
};
Misclassified compare_classes(const PixelLabels& classes, const PixelLabels& truth, double reach_px = 3);

}  // namespace heartgen::study
