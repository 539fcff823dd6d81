// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/mesh_certificate.hpp"

#include <algorithm>

#include "generator/mesh/domain.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/walls.hpp"
#include "generator/parallel/tasks.hpp"
#include "generator/pipeline/resolutions.hpp"
#include "model/labels.hpp"
#include "validation/curve_fidelity.hpp"
#include "validation/label_fidelity.hpp"
#include "validation/mesh_checks.hpp"

namespace heartgen::pipeline {
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

bool is_any(Region /*region*/) { return true; }

/// The regions that a mesh holds, from its name in a bundle.
using Holds = bool (*)(Region);
Holds regions_of(const std::string& mesh_name) {
  if (mesh_name == "torso") return is_any;
  return mesh_name == "chambers" ? is_blood : is_myocardium;
}

LabelVolume only(LabelVolume labels, Holds holds) {
  for (auto& voxel : labels.voxels)
    if (!holds(static_cast<Region>(voxel))) voxel = 0;
  return labels;
}

bool in_field_of_view(const Grid& grid, const Vec3& index) {
  for (int axis = 0; axis < 3; ++axis)
    if (index[axis] < -0.5 || index[axis] > static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5)
      return false;
  return true;
}

/// `labels` is what the mesh was made of together with its neighbours; what it does not hold is outside of it.
Report fidelity_rows(const std::string& mesh_name, const TetMesh& mesh, const std::vector<validation::MeshFace>& faces,
                     const LabelVolume& labels, Holds holds, const MeshSettings& mesh_settings,
                     const ValidationSettings& bounds) {
  const auto domain = mesh::make_domain(labels, mesh_settings);
  const auto label_at = [&domain, holds](const Vec3& lps_mm) -> int {
    const Vec3 index = index_from_lps(domain.grid, lps_mm);
    if (!in_field_of_view(domain.grid, index)) return 0;
    const int region = mesh::region_at(domain, index);
    return holds(static_cast<Region>(region)) ? region : 0;
  };
  const auto own = only(labels, holds);
  auto rows = validation::check_against_labels(mesh_name, mesh, faces, own, bounds);
  append(rows, validation::check_against_level_sets(mesh_name, mesh, faces, own.grid, label_at, bounds));
  append(rows, validation::check_curves(mesh_name, mesh, faces, own, label_at));
  return rows;
}

}  // namespace

Report check_fidelity(const std::string& mesh_name, const TetMesh& mesh, const LabelVolume& labels,
                      const MeshSettings& mesh_settings, const ValidationSettings& bounds) {
  return fidelity_rows(mesh_name, mesh, validation::mesh_faces(mesh), labels, is_any, mesh_settings, bounds);
}

Report check_fidelity(const std::string& mesh_name, const TetMesh& mesh, const mesh::WallLevelSets& walls,
                      const ValidationSettings& bounds) {
  const auto labels = mesh::labels_of(walls);
  const auto label_at = [&](const Vec3& lps_mm) -> int {
    return in_field_of_view(labels.grid, index_from_lps(labels.grid, lps_mm)) ? mesh::wall_at(walls, lps_mm) : 0;
  };
  const auto faces = validation::mesh_faces(mesh);
  auto rows = validation::check_against_labels(mesh_name, mesh, faces, labels, bounds);
  append(rows, validation::check_against_level_sets(mesh_name, mesh, faces, labels.grid, label_at, bounds));
  return rows;
}

ReportParts mesh_certificate(const std::map<std::string, TetMesh>& meshes, const validation::FacesOfMeshes& faces,
                             const LabelVolume& labels, const MeshSettings& mesh_settings,
                             const ValidationSettings& bounds) {
  ReportParts parts;
  for (const auto& [mesh_name, named] : meshes)
    parts.push_back({[&faces, bounds, name = mesh_name, &mesh = named] {
      return validation::check_mesh(name, mesh, faces.at(name), bounds);
    }});
  if (labels.voxels.empty()) return parts;
  const auto add_fidelity = [&](const std::string& mesh_name, bool whole_map) {
    const auto rows = [&meshes, &faces, &labels, &mesh_settings, bounds, name = mesh_name, whole_map] {
      return fidelity_rows(name, meshes.at(name), faces.at(name), whole_map ? labels : mesh::heart_only(labels),
                           regions_of(name), mesh_settings, bounds);
    };
    parts.push_back({rows, true});
  };
  for (const auto& name : whole_meshes(meshes)) add_fidelity(name, meshes.contains("torso"));
  for (const double edge : mesh_settings.resolutions_mm)
    if (meshes.contains(resolution_name(edge))) add_fidelity(resolution_name(edge), false);
  return parts;
}

Report joined(const ReportParts& parts) {
  std::vector<Report> reports(parts.size());
  std::vector<std::function<void()>> tasks;
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (!parts[p].is_long) tasks.emplace_back([&, p] { reports[p] = parts[p].rows(); });
  parallel::run_tasks(tasks);
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (parts[p].is_long) reports[p] = parts[p].rows();
  Report all;
  for (const auto& report : reports) append(all, report);
  return all;
}

}  // namespace heartgen::pipeline
