// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The labelling of least cost: iterated conditional modes (Besag, J R Stat Soc B 48:259, 1986) from many starts, then
/// iterated local search. Deterministic, the same for any number of threads.
#pragma once
#include <vector>

#include "generator/naming/labelling.hpp"

namespace heartgen::naming {

struct Solution {
  std::vector<Name> names;
  double energy = 0;
};

/// How long the search goes on.
struct Effort {
  int starts = 24;         ///< that are followed to their minimum
  int restarted = 3;       ///< of these, from whose left heart the rest is named anew
  int shaken = 6;          ///< of the best
  int shakes = 400;        ///< of each
  int final_shakes = 800;  ///< of the best
};

/// The best solution; nothing where no piece of deep blood has a shell of muscle.
std::vector<Name> solve(const Problem& problem, const Effort& effort = {});

/// Pieces that keep their name; empty: none does.
using Fixed = std::vector<bool>;

/// Gives every piece but the fixed ones the name that costs least while all others keep theirs, and exchanges or unites
/// names, until nothing gets better. Returns the energy.
double descend(Labelling& labelling, const Fixed& fixed = {}, int sweeps = 12);

/// Renames bodies of pieces at random and lets their neighbourhood settle; what costs less stays. Returns the energy.
double shake(Labelling& labelling, std::uint64_t key, int times, const Fixed& fixed = {});

}  // namespace heartgen::naming
