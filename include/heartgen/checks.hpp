// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What is measured on label maps, meshes, fibres and whole bundles, with bounds and verdicts. Checks know nothing of
/// what made a mesh. Not collective; everything throws UserError.
#pragma once
#include <filesystem>
#include <string>

#include "heartgen/meshes.hpp"
#include "model/certificate.hpp"
#include "model/recipe.hpp"
#include "validation/label_checks.hpp"
#include "validation/mesh_checks.hpp"
#include "validation/reference_fibers.hpp"

namespace heartgen {

using validation::check_labels;
using validation::check_mesh;
using validation::ReferenceFibers;

/// The rows of one mesh with bounds that solvers get on with, its regions and surfaces called by their own names.
Report check_mesh(const MeshFile& file);

/// What a bundle may be compared with; either may be null.
struct KnownTruth {
  const LabelVolume* labels = nullptr;
  const ReferenceFibers* fibers = nullptr;
};

/// The certificate of a bundle, measured again, as `heartgen validate` prints it. A damaged bundle is refused.
Certificate validate_bundle(const std::filesystem::path& bundle, const KnownTruth& truth = {});

}  // namespace heartgen
