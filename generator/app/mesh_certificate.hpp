// The certificate of a bundle's meshes: each by itself, and those that fill the label map against it.
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

namespace heart::app {

/// Rows of a report in parts that do not depend on each other: they may be made at the same time.
using ReportParts = std::vector<std::function<Report()>>;

/// Made on all threads; the same rows in the same order for any number of them.
Report joined(const ReportParts& parts);

/// Rows of group "mesh". Without labels (no voxels) the meshes are checked by themselves only. `faces` of each of the
/// meshes. The parts refer to all arguments.
ReportParts mesh_certificate(const std::map<std::string, TetMesh>& meshes, const validation::FacesOfMeshes& faces,
                             const LabelVolume& labels, const MeshSettings& mesh_settings,
                             const ValidationSettings& bounds);

/// A mesh that was made of the whole label map, against it.
Report check_fidelity(const std::string& mesh_name, const TetMesh& mesh, const LabelVolume& labels,
                      const MeshSettings& mesh_settings, const ValidationSettings& bounds);

}  // namespace heart::app
