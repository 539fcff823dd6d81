// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/registry.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "exporters/decks.hpp"
#include "exporters/files.hpp"
#include "exporters/formats.hpp"
#include "exporters/out_file.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/text.hpp"

namespace heartgen::exporters {
namespace {

constexpr std::array formats = {
    ExportFormat{"vtk", ".vtk", "legacy VTK 3.0, binary; faces in NAME_surfaces.vtk", "mm", &export_vtk_binary},
    ExportFormat{"vtk-ascii", ".vtk", "legacy VTK 3.0, text", "mm", &export_vtk_ascii},
    ExportFormat{"vtu", ".vtu", "VTK XML as in the bundle; faces in NAME.vtp", "mm", &export_vtu},
    ExportFormat{"msh", ".msh", "gmsh 4.1, binary, physical names, fibres as views", "mm", &export_msh41_binary},
    ExportFormat{"msh-ascii", ".msh", "gmsh 4.1, text (deal.II: add --no-interfaces)", "mm", &export_msh41_ascii},
    ExportFormat{"msh2", ".msh", "gmsh 2.2, text; fibres per cell in NAME_cells.msh", "mm", &export_msh22_ascii},
    ExportFormat{"dealii", ".msh", "deal.II, lifex: gmsh 2.2 with outer faces only", "mm", &export_dealii},
    ExportFormat{"xdmf", ".xdmf", "dolfinx: XDMF + HDF5; faces in NAME_facets.xdmf", "mm", &export_xdmf},
    ExportFormat{"opencarp", ".pts", "openCARP .pts .elem .lon .vtx .surf", "um", &export_opencarp},
    ExportFormat{"opencarp-binary", ".bpts", "openCARP .bpts .belem .blon, .vtx, .surf", "um", &export_opencarp_binary},
    ExportFormat{"chaste", ".node", "Chaste .node .ele .face .ortho", "cm", &export_chaste},
    ExportFormat{"svmultiphysics", ".vtu", "svMultiPhysics: a mesh-complete folder", "mm", &export_svmultiphysics},
    ExportFormat{"openfoam", "", "OpenFOAM: a case with constant/polyMesh and 0/", "m", &export_openfoam},
    ExportFormat{"cardiacfoam", ".vtk", "cardiacFoam: legacy VTK with `tags`", "m", &export_cardiacfoam},
    ExportFormat{"medit", ".mesh", "FreeFEM, mmg, TetGen: Medit .mesh; fibres as text", "mm", &export_medit},
    ExportFormat{"mfem", ".mesh", "MFEM v1.0 with boundary; fibres as GridFunction", "mm", &export_mfem},
    ExportFormat{"cardioid", ".vtk", "Cardioid, MFEM: legacy VTK with `material`", "mm", &export_cardioid},
    ExportFormat{"abaqus", ".inp", "CalculiX, Abaqus: sets, surfaces, orientations", "mm", &export_abaqus},
    ExportFormat{"febio", ".feb", "FEBio 4.0: sets, surfaces, mat_axis", "mm", &export_febio},
    ExportFormat{"stl", ".stl", "every surface for printers and viewers, binary", "mm", &export_stl},
    ExportFormat{"ply", ".ply", "every surface, binary", "mm", &export_ply},
    ExportFormat{"obj", ".obj", "every surface, text", "mm", &export_obj},
    ExportFormat{"vtp", ".vtp", "every surface as VTK XML", "mm", &export_vtp},
};

constexpr std::array<std::pair<std::string_view, double>, 4> units = {
    {{"mm", 1.0}, {"um", 1000.0}, {"cm", 0.1}, {"m", 0.001}}};

template <class Table, class Name>
std::string names_in(const Table& table, const Name& name) {
  std::string text;
  for (const auto& row : table) text += (text.empty() ? "" : ", ") + std::string(name(row));
  return text;
}

std::map<std::int32_t, std::vector<std::size_t>> grouped(const std::vector<std::int32_t>& tags) {
  std::map<std::int32_t, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < tags.size(); ++i) groups[tags[i]].push_back(i);
  return groups;
}

Files written(const ExportFormat& format, const ExportTask& task) {
  Files files = format.function(task);
  const bool are_surfaces = format.description.starts_with("every surface");
  if (!are_surfaces) files = joined(std::move(files), write_cavities(task));
  for (auto& file : write_deck(format, task)) files.push_back(std::move(file));
  return files;
}

std::optional<std::string> own_name(const TetMesh& mesh, int dimension, std::int32_t tag) {
  const auto found = mesh.names.find({dimension, tag});
  return found == mesh.names.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

std::span<const ExportFormat> export_formats() { return formats; }

const ExportFormat& find_format(std::string_view name) {
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const auto& f) { return f.name == name; });
  if (found == formats.end())
    throw UserError("unknown format '" + std::string(name) + "'", "export",
                    "known: " + names_in(formats, [](const auto& f) { return f.name; }));
  return *found;
}

double unit_scale(std::string_view unit) {
  const auto found = std::find_if(units.begin(), units.end(), [&](const auto& u) { return u.first == unit; });
  if (found == units.end())
    throw UserError("unknown unit '" + std::string(unit) + "'", "export",
                    "known: " + names_in(units, [](const auto& u) { return u.first; }));
  return found->second;
}

Files export_mesh(std::string_view format, const TetMesh& mesh, const std::string& mesh_name,
                  const std::filesystem::path& folder, std::string_view unit) {
  const ExportFormat& chosen = find_format(format);
  if (unit.empty()) unit = chosen.unit;
  const double scale = unit_scale(unit);
  in_file_name(mesh_name);
  if (mesh.cells.empty())
    throw UserError("mesh '" + mesh_name + "' has no cells", "export", "shorter edges keep what is small or thin");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw UserError("cannot be made: " + error.message(), folder.string(), "name another output folder");
  if (scale == 1) return written(chosen, {mesh, mesh_name, folder, std::string(unit)});
  TetMesh scaled = mesh;
  for (auto& node : scaled.nodes_mm) node *= scale;
  return written(chosen, {scaled, mesh_name, folder, std::string(unit)});
}

std::map<std::int32_t, std::string> regions_of(const TetMesh& mesh) {
  std::map<std::int32_t, std::string> names;
  for (const auto tag : mesh.region) names.try_emplace(tag);
  for (auto& [tag, name] : names) name = own_name(mesh, 3, tag).value_or(region_name(tag));
  return names;
}

std::map<std::int32_t, std::string> surfaces_of(const TetMesh& mesh) {
  std::map<std::int32_t, std::string> names;
  for (const auto tag : mesh.surface) names.try_emplace(tag);
  for (auto& [tag, name] : names) name = own_name(mesh, 2, tag).value_or(surface_name(tag));
  return names;
}

std::map<std::int32_t, std::vector<std::size_t>> faces_by_surface(const TetMesh& mesh) { return grouped(mesh.surface); }

std::map<std::int32_t, std::vector<std::size_t>> cells_by_region(const TetMesh& mesh) { return grouped(mesh.region); }

std::map<std::string, std::vector<std::size_t>> cells_by_user_region(const TetMesh& mesh) {
  std::map<std::string, std::vector<std::size_t>> cells;
  for (const auto& region : mesh.user_regions)
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      if (mesh.user_region[c] == region.tag) cells[region.name].push_back(c);
  return cells;
}

std::string fraction_name(const UserRegion& region) { return "fraction_" + region.name; }

FiberField cell_axes(const TetMesh& mesh, WithoutFibers without) {
  const std::vector<Vec3> none(mesh.cells.size());
  FiberField axes = has_fibers(mesh) ? mesh.cell_fibers : FiberField{none, none, none};
  if (without == WithoutFibers::zero) return axes;
  for (std::size_t c = 0; c < axes.fiber.size(); ++c) {
    if (axes.fiber[c] != Vec3{}) continue;
    axes.fiber[c] = {1, 0, 0};
    axes.sheet[c] = {0, 1, 0};
    axes.sheet_normal[c] = {0, 0, 1};
  }
  return axes;
}

Files write_user_regions(const ExportTask& task) {
  const TetMesh& mesh = task.mesh;
  if (mesh.user_regions.empty()) return {};
  OutFile file(task.folder / (task.mesh_name + "_user_regions.csv"));
  file.print(FMT_COMPILE("cell,user_region"));
  for (const auto& region : mesh.user_regions) file.print(FMT_COMPILE(",{}"), fraction_name(region));
  file.print(FMT_COMPILE("\n"));
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto is_in = [c](const UserRegion& region) { return region.fraction[c] > 0; };
    if (std::none_of(mesh.user_regions.begin(), mesh.user_regions.end(), is_in)) continue;
    file.print(FMT_COMPILE("{},{}"), c, mesh.user_region[c]);
    for (const auto& region : mesh.user_regions) file.print(FMT_COMPILE(",{}"), region.fraction[c]);
    file.print(FMT_COMPILE("\n"));
  }
  return {file.close()};
}

Files write_cavities(const ExportTask& task) {
  if (task.mesh.cavities.empty()) return {};
  OutFile file(task.folder / (task.mesh_name + "_cavities.csv"));
  file.print(FMT_COMPILE("cavity,surface,node_0,node_1,node_2\n"));
  for (const auto& cavity : task.mesh.cavities)
    for (std::size_t f = 0; f < cavity.faces.size(); ++f) {
      const Face& n = cavity.faces[f];
      file.print(FMT_COMPILE("{},{},{},{},{}\n"), cavity.name, surface_name(cavity.surface[f]), n[0], n[1], n[2]);
    }
  return {file.close()};
}

std::filesystem::path write_markers(const ExportTask& task) {
  nlohmann::ordered_json markers = nlohmann::ordered_json::object();
  for (const auto& [tag, name] : regions_of(task.mesh)) markers[name] = {tag, 3};
  for (const auto& [tag, name] : surfaces_of(task.mesh)) markers[name] = {tag, 2};
  for (const auto& rim : task.mesh.rims) markers[rim.name] = {rim.tag, 0};
  auto path = task.folder / (task.mesh_name + "_markers.json");
  write_text(path, markers.dump(2) + "\n");
  return path;
}

}  // namespace heartgen::exporters
