// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The walls of the heart at further edge lengths (mesh.resolutions_mm), with the fibres of the bundle's main mesh.
#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "model/recipe.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::pipeline {

/// e.g. "myocardium_0.8mm", "myocardium_2mm"
std::string resolution_name(double edge_mm);

/// Throws UserError naming mesh.resolutions_mm for edges outside 0.4 to 3 mm and for the same edge twice.
void check_resolutions(const MeshSettings& settings);

struct Resolutions {
  std::map<std::string, TetMesh> meshes;      ///< by resolution_name
  std::map<std::string, double> farthest_mm;  ///< of its nodes from the main mesh, whose fibres it has
};

/// What meshing the walls of `labels` at an edge needs at most, with its fibres, checks and files: from volumes and
/// areas of the label map and the cells and bytes that they took on phantoms.
double estimate_bytes(const LabelVolume& labels, double edge_mm);

/// Throws UserError where an edge of mesh.resolutions_mm, or one of heart, blood or torso, needs more than
/// `memory_bytes` (0: unknown, nothing is refused).
void check_memory(const LabelVolume& labels, const MeshSettings& settings, double memory_bytes);

/// One mesh per edge of mesh.resolutions_mm, out of the same label map with the same regions, surfaces and rims.
/// `myocardium` is the main mesh, with fibres. Throws UserError as mesh_heart. Not collective.
Resolutions make_resolutions(const LabelVolume& labels, const MeshSettings& settings, const TetMesh& myocardium);

/// Rows of the fibre certificate for the further meshes that `meshes` holds, as for the main mesh, under their names.
Report check_resolution_fibers(const std::map<std::string, TetMesh>& meshes, const MeshSettings& mesh_settings,
                               const ValidationSettings& bounds);

/// How far their nodes lie from the main mesh.
Report resolution_distances(const Resolutions& resolutions);

}  // namespace heartgen::pipeline
