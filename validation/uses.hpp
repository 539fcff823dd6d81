// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fit for what: the simulations that people run on a heart, and what each of them asks of a model.
#pragma once
#include <string>
#include <vector>

#include "model/certificate.hpp"
#include "model/recipe.hpp"

namespace heartgen::validation {

/// Names of all uses, in the order of the table.
std::vector<std::string> use_names();

/// A verdict for each use whose meshes are among `mesh_names`. Unfit: a row of its meshes, or of the fibres where it
/// needs them, fails; a bound of its own is broken, or the model is doubtful. `asked` are the uses that the recipe
/// names; empty: all that the recipe's edges and the scan allow. Rows must be judged.
std::vector<UseVerdict> judge_uses(const Report& rows, const std::vector<Warning>& warnings,
                                   const std::vector<std::string>& mesh_names, const std::vector<std::string>& asked);

/// Rows judged by `criteria`, with warnings and verdicts on uses. A warning (`uses.NAME`) says that the meshes are too
/// coarse for eikonal or mechanics, where the recipe does not ask for it.
Certificate certified(Report rows, std::vector<Warning> warnings, const std::vector<std::string>& mesh_names,
                      const ValidationSettings& settings);

}  // namespace heartgen::validation
