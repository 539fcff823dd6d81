// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// From a recipe to a model bundle: all stages as one list.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "exporters/bundle.hpp"
#include "generator/parallel/comm.hpp"
#include "generator/pipeline/stage_event.hpp"
#include "model/fiber_atlas.hpp"
#include "model/recipe.hpp"

namespace heartgen::pipeline {

struct BuildOptions {
  std::filesystem::path output;        ///< folder of the bundle
  std::filesystem::path cache_folder;  ///< stage results; empty: no cache
  std::filesystem::path keep_stages;   ///< where the image stages' results are written as files; empty: nowhere
  bool replace = false;                ///< replace an existing bundle
  bool progress = true;                ///< lines on standard error
  bool tells_warnings = true;          ///< on standard error, as they come up; they are in the certificate too
  bool accept_doubtful = false;        ///< go on with automatic landmarks that can hardly be a heart's
  /// Called on the root; what it throws ends the build of a single process.
  std::function<void(const StageEvent&)> on_stage{};
};

struct BuildResult {
  std::string content_id;
  Certificate certificate;
  std::string log;  ///< seconds per stage
};

/// Runs every stage and writes the bundle; the result counts on the root. @collective
/// Throws UserError (on every rank) for bad input; what can be checked is checked before the first stage.
BuildResult build(const Recipe& recipe, const BuildOptions& options, const parallel::Comm& comm);

/// The atlas that is taken where none is given.
FiberAtlas standin_atlas();

/// Of a bundle's meshes, sorted.
std::vector<std::string> names_of(const std::map<std::string, TetMesh>& meshes);

/// The certificate of a bundle's meshes as `build` and `validate` make it: mesh and fibre checks, and the meshes
/// against their label map.
Report certificate(const std::map<std::string, TetMesh>& meshes, const LabelVolume& labels,
                   const MeshSettings& mesh_settings, const ValidationSettings& settings);

}  // namespace heartgen::pipeline
