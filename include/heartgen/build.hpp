// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// From a recipe to a model bundle: everything that `heartgen build` does.
#pragma once
#include "generator/parallel/comm.hpp"
#include "generator/pipeline/pipeline.hpp"
#include "model/error.hpp"
#include "model/recipe.hpp"

namespace heartgen {

using pipeline::build;
using pipeline::BuildOptions;
using pipeline::BuildResult;
using pipeline::StageEvent;

/// A recipe with every setting's default, as `heartgen build` without a recipe takes it.
Recipe default_recipe();

}  // namespace heartgen
