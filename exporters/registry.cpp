#include "exporters/registry.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "exporters/formats.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/text.hpp"

namespace heart::exporters {
namespace {

constexpr std::array formats = {
    ExportFormat{"vtk", ".vtk", "legacy VTK 3.0, binary; faces in NAME_surfaces.vtk", "mm", &export_vtk_binary},
    ExportFormat{"vtk-ascii", ".vtk", "legacy VTK 3.0, text", "mm", &export_vtk_ascii},
    ExportFormat{"vtu", ".vtu", "VTK XML as in the bundle; faces in NAME.vtp", "mm", &export_vtu},
    ExportFormat{"msh", ".msh", "gmsh 4.1, binary, physical names, fibres as views", "mm", &export_msh41_binary},
    ExportFormat{"msh-ascii", ".msh", "gmsh 4.1, text", "mm", &export_msh41_ascii},
    ExportFormat{"msh2", ".msh", "gmsh 2.2, text", "mm", &export_msh22_ascii},
    ExportFormat{"xdmf", ".xdmf", "XDMF + HDF5 as dolfinx reads it; faces in NAME_facets.xdmf", "mm", &export_xdmf},
    ExportFormat{"opencarp", ".pts", "openCARP .pts .elem .lon .vtx", "um", &export_opencarp},
    ExportFormat{"chaste", ".node", "Chaste .node .ele .face .ortho", "cm", &export_chaste},
    ExportFormat{"svmultiphysics", ".vtu", "svMultiPhysics volume, fibre and face files", "mm", &export_svmultiphysics},
    ExportFormat{"mfem", ".vtk", "MFEM, Cardioid: legacy VTK with `material`", "mm", &export_mfem},
    ExportFormat{"cardiacfoam", ".vtk", "cardiacFoam: legacy VTK with `tags`", "m", &export_cardiacfoam},
};

constexpr std::array<std::pair<std::string_view, double>, 4> units = {
    {{"mm", 1.0}, {"um", 1000.0}, {"cm", 0.1}, {"m", 0.001}}};

template <class Table, class Name>
std::string names_in(const Table& table, const Name& name) {
  std::string text;
  for (const auto& row : table) text += (text.empty() ? "" : ", ") + std::string(name(row));
  return text;
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
  const double scale = unit_scale(unit.empty() ? chosen.unit : unit);
  if (mesh.cells.empty())
    throw UserError("mesh '" + mesh_name + "' has no cells", "export", "shorter edges keep what is small or thin");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw UserError("cannot be made: " + error.message(), folder.string(), "name another output folder");
  if (scale == 1) return chosen.function({mesh, mesh_name, folder});
  TetMesh scaled = mesh;
  for (auto& node : scaled.nodes_mm) node *= scale;
  return chosen.function({scaled, mesh_name, folder});
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

FiberField cell_axes(const TetMesh& mesh) {
  if (has_fibers(mesh)) return mesh.cell_fibers;
  const std::vector<Vec3> none(mesh.cells.size());
  return {none, none, none};
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

}  // namespace heart::exporters
