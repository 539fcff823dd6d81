// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Whether a labelling is a heart's.
#pragma once
#include <string>
#include <vector>

#include "generator/naming/naming.hpp"

namespace heartgen::naming {

/// Sets verdict and reasons of what has been named. `labelling` is the best one.
void judge(const Labelling& labelling, Naming& naming);

}  // namespace heartgen::naming
