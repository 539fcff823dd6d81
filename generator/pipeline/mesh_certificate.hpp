// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The certificate of a bundle's meshes: each by itself, and those that fill the label map against it.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "model/recipe.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::mesh {
struct WallLevelSets;
}

namespace heartgen::pipeline {

/// Rows of a report that depend on no others.
struct ReportPart {
  std::function<Report()> rows;
  bool is_long = false;  ///< made by itself on all threads, where others are made at the same time, one on each
};
using ReportParts = std::vector<ReportPart>;

/// The same rows in the order of the parts for any number of threads.
Report joined(const ReportParts& parts);

/// Rows of group "mesh". Without labels (no voxels) the meshes are checked by themselves only. `faces` of each of the
/// meshes. The parts refer to all arguments but the bounds, which they hold.
ReportParts mesh_certificate(const std::map<std::string, TetMesh>& meshes, const validation::FacesOfMeshes& faces,
                             const LabelVolume& labels, const MeshSettings& mesh_settings,
                             const ValidationSettings& bounds);

/// A mesh that was made of the whole label map, against it.
Report check_fidelity(const std::string& mesh_name, const TetMesh& mesh, const LabelVolume& labels,
                      const MeshSettings& mesh_settings, const ValidationSettings& bounds);

/// A mesh of the walls alone, against their level sets.
Report check_fidelity(const std::string& mesh_name, const TetMesh& mesh, const mesh::WallLevelSets& walls,
                      const ValidationSettings& bounds);

}  // namespace heartgen::pipeline
