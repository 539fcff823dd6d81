// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// From a recipe to a model bundle: all stages as one table.
#pragma once
#include <string>

#include "generator/parallel/comm.hpp"
#include "generator/pipeline/build.hpp"

namespace heartgen::pipeline {

struct BuildResult {
  std::string content_id;
  Certificate certificate;
  std::string log;  ///< seconds per stage
};

/// Runs every stage and writes the bundle; the result counts on the root. @collective
/// Throws UserError (on every rank) for bad input; what can be checked is checked before the first stage.
BuildResult build(const Recipe& recipe, const BuildOptions& options, const parallel::Comm& comm);

}  // namespace heartgen::pipeline
