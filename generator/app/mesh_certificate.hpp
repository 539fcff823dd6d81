// The certificate of a bundle's meshes: each by itself, and those that fill the label map against it.
#pragma once
#include <map>
#include <string>

#include "model/recipe.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heart::app {

/// Rows of group "mesh". Without labels (no voxels) the meshes are checked by themselves only.
Report mesh_certificate(const std::map<std::string, TetMesh>& meshes, const LabelVolume& labels,
                        const MeshSettings& mesh_settings, const ValidationSettings& bounds);

/// A mesh that was made of the whole label map, against it.
Report check_fidelity(const std::string& mesh_name, const TetMesh& mesh, const LabelVolume& labels,
                      const MeshSettings& mesh_settings, const ValidationSettings& bounds);

}  // namespace heart::app
