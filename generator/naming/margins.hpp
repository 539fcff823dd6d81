// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How sure each name is: what the best labelling costs more in which half of its blood, its largest pieces, is called
/// something else.
#pragma once
#include "generator/naming/solve.hpp"

namespace heartgen::naming {

struct Margin {
  double cost = 0;               ///< large: sure
  Name runner_up = Name::other;  ///< what that half would be called then
};

struct Judged {
  Solution solution;
  std::array<Margin, name_count> margins{};  ///< by name; 0 for what is not found
};

/// A better solution that turns up on the way takes the place of `names`.
Judged judge_margins(const Problem& problem, std::vector<Name> names);

}  // namespace heartgen::naming
