#include "generator/app/mesh_certificate.hpp"

#include <algorithm>

#include "generator/mesh/domain.hpp"
#include "model/labels.hpp"
#include "validation/label_fidelity.hpp"
#include "validation/mesh_checks.hpp"

namespace heart::app {
namespace {

void append(Report& report, const Report& rows) { report.insert(report.end(), rows.begin(), rows.end()); }

/// The meshes that together fill the label map: the torso, or where there is none the parts of the heart.
std::vector<std::string> whole_meshes(const std::map<std::string, TetMesh>& meshes) {
  if (meshes.contains("torso")) return {"torso"};
  std::vector<std::string> parts;
  for (const char* name : {"myocardium", "chambers"})
    if (meshes.contains(name)) parts.emplace_back(name);
  return parts;
}

LabelVolume heart_only(LabelVolume labels) {
  for (auto& voxel : labels.voxels)
    if (!is_myocardium(static_cast<Region>(voxel)) && !is_blood(static_cast<Region>(voxel))) voxel = 0;
  return labels;
}

/// Without the heart's other mesh, where there are two.
LabelVolume only_regions(LabelVolume labels, const std::string& mesh_name) {
  for (auto& voxel : labels.voxels)
    if ((mesh_name == "myocardium" && !is_myocardium(static_cast<Region>(voxel))) ||
        (mesh_name == "chambers" && !is_blood(static_cast<Region>(voxel))))
      voxel = 0;
  return labels;
}

bool in_field_of_view(const Grid& grid, const Vec3& index) {
  for (int axis = 0; axis < 3; ++axis)
    if (index[axis] < -0.5 || index[axis] > static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5)
      return false;
  return true;
}

}  // namespace

Report check_fidelity(const std::string& mesh_name, const TetMesh& mesh, const LabelVolume& labels,
                      const MeshSettings& mesh_settings, const ValidationSettings& bounds) {
  const auto domain = mesh::make_domain(labels, mesh_settings);
  const auto label_at = [&domain](const Vec3& lps_mm) -> int {
    const Vec3 index = index_from_lps(domain.grid, lps_mm);
    return in_field_of_view(domain.grid, index) ? mesh::region_at(domain, index) : 0;
  };
  return validation::check_against_labels(mesh_name, mesh, only_regions(labels, mesh_name), label_at, bounds);
}

Report mesh_certificate(const std::map<std::string, TetMesh>& meshes, const LabelVolume& labels,
                        const MeshSettings& mesh_settings, const ValidationSettings& bounds) {
  Report report;
  for (const auto& [name, mesh] : meshes) append(report, validation::check_mesh(name, mesh, bounds));
  if (labels.voxels.empty()) return report;
  const LabelVolume& meshed = meshes.contains("torso") ? labels : heart_only(labels);
  for (const auto& name : whole_meshes(meshes))
    append(report, check_fidelity(name, meshes.at(name), meshed, mesh_settings, bounds));
  return report;
}

}  // namespace heart::app
