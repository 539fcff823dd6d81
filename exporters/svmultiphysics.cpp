// SPDX-License-Identifier: GPL-3.0-or-later
// svMultiPhysics, the folder NAME-mesh-complete:
//   mesh-complete.mesh.vtu      cell arrays GlobalElementID, DOMAIN_ID (the region's tag), point array GlobalNodeID
//   mesh-complete.exterior.vtp  the outer boundary; mesh-surfaces/SURFACE.vtp every named surface: GlobalNodeID, and
//                               GlobalElementID, the tetrahedron behind the face (of two, the one of the lower id)
//   cavities.vtp                closed surfaces of the blood pools: the mesh's faces and caps over their openings,
//   which
//                               belong to no tetrahedron: cell arrays cavity, surface, point array GlobalNodeID
//   fiber.vtu, sheet.vtu        cell array FIB_DIR, 3 × float64, one file per family; coordinate axes where there is no
//                               muscle, because parallel or zero families are refused
//   domain_ids.dat              a domain per tetrahedron: the region's tag, or that of the stimulated site; the number
//                               itself, no bit mask (set_dmn_id_ff in the solver's read_msh.cpp)
// All ids are int32 and 1-based.
#include <algorithm>
#include <numeric>

#include "exporters/adjacency.hpp"
#include "exporters/decks.hpp"
#include "exporters/files.hpp"
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/priors.hpp"

namespace heartgen::exporters {
namespace {

std::vector<std::int32_t> one_to(std::size_t count) {
  std::vector<std::int32_t> ids(count);
  std::iota(ids.begin(), ids.end(), 1);
  return ids;
}

void require_domains(const TetMesh& mesh) {
  for (const auto& [tag, name] : regions_of(mesh))
    if (tag < 1 || tag >= stimulus_domain)
      throw UserError(fmt::format("region {} has the number {}", name, tag), "svmultiphysics",
                      fmt::format("its domains have numbers from 1 to {}: give the region one", stimulus_domain - 1));
}

std::filesystem::path write_volume(const std::filesystem::path& folder, const TetMesh& mesh) {
  auto path = folder / "mesh-complete.mesh.vtu";
  adapters::write_vtu(path, mesh,
                      {{"GlobalElementID", one_to(mesh.cells.size())},
                       {"DOMAIN_ID", mesh.region},
                       {"user_region", mesh.user_region}},  // left out where it is empty
                      {{"GlobalNodeID", one_to(mesh.nodes_mm.size())}});
  return path;
}

std::filesystem::path write_family(const std::filesystem::path& path, const TetMesh& mesh, std::vector<Vec3> axes) {
  adapters::UnstructuredData data;
  data.points = mesh.nodes_mm;
  data.tets = mesh.cells;
  data.cell_vectors["FIB_DIR"] = std::move(axes);
  adapters::write_unstructured(path, data);
  return path;
}

/// The regions, and a domain of its own for ventricular cells at the site that the deck stimulates: this solver
/// stimulates whole domains.
std::filesystem::path write_domains(const std::filesystem::path& folder, const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  const Vec3 site = septal_site(mesh);
  const double radius = priors::stimulus_radius_mm * unit_scale(task.unit);
  OutFile file(folder / "domain_ids.dat");
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const bool is_site = is_myocardium(static_cast<Region>(mesh.region[c])) &&
                         std::any_of(mesh.cells[c].begin(), mesh.cells[c].end(), [&](std::int32_t node) {
                           return norm(mesh.nodes_mm[static_cast<std::size_t>(node)] - site) <= radius;
                         });
    file.print(FMT_COMPILE("{}\n"), is_site ? stimulus_domain : mesh.region[c]);
  }
  return file.close();
}

std::filesystem::path write_patch(const std::filesystem::path& path, const TetMesh& mesh,
                                  const std::vector<std::size_t>& faces, const std::vector<FaceCells>& sides) {
  std::vector<std::int32_t> elements;
  elements.reserve(faces.size());
  for (const auto f : faces) elements.push_back(sides[f][0] + 1);
  adapters::write_vtp(path, mesh, faces, {{"GlobalElementID", elements}});
  return path;
}

std::vector<std::size_t> outer_faces(const std::vector<FaceCells>& sides) {
  std::vector<std::size_t> outer;
  for (std::size_t f = 0; f < sides.size(); ++f)
    if (sides[f][1] < 0) outer.push_back(f);
  return outer;
}

}  // namespace

Files export_svmultiphysics(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  require_domains(mesh);
  const auto folder = task.folder / (task.mesh_name + "-mesh-complete");
  const auto sides = cells_of_faces(mesh);
  Files files = {write_volume(folder, mesh), write_domains(folder, task), write_markers(task)};
  if (has_fibers(mesh)) {
    auto axes = cell_axes(mesh, WithoutFibers::coordinate_axes);
    files.push_back(write_family(folder / "fiber.vtu", mesh, std::move(axes.fiber)));
    files.push_back(write_family(folder / "sheet.vtu", mesh, std::move(axes.sheet)));
  }
  files.push_back(write_patch(folder / "mesh-complete.exterior.vtp", mesh, outer_faces(sides), sides));
  for (auto& file : write_user_regions(task)) files.push_back(std::move(file));
  const auto names = surfaces_of(mesh);
  for (const auto& [tag, faces] : faces_by_surface(mesh))
    files.push_back(write_patch(folder / "mesh-surfaces" / (in_file_name(names.at(tag)) + ".vtp"), mesh, faces, sides));
  if (mesh.cavities.empty()) return files;
  files.push_back(folder / "cavities.vtp");
  adapters::write_cavities(files.back(), mesh);
  return files;
}

}  // namespace heartgen::exporters
