// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The last stage of a build: certificate, report, files.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "generator/pipeline/stages.hpp"
#include "model/labels.hpp"

namespace heartgen::pipeline {

Stages bundle_stages();

exporters::Existing existing_output(const BuildOptions& options);

/// Regions that meshing and fibres cannot do without.
std::vector<Region> needed_regions();

/// Of a bundle's meshes, sorted.
std::vector<std::string> names_of(const std::map<std::string, TetMesh>& meshes);

/// The certificate of a bundle's meshes as `build` and `validate` make it: mesh and fibre checks, and the meshes
/// against their label map. Rows of walls hold their annuli: what insulates is judged by rows of its own.
Report certificate(std::map<std::string, TetMesh> meshes, const LabelVolume& labels, const MeshSettings& mesh_settings,
                   const ValidationSettings& settings);

}  // namespace heartgen::pipeline
