// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh_files/any_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "generator/adapters/vtk_io.hpp"
#include "generator/mesh_files/carp_file.hpp"
#include "generator/mesh_files/medit_file.hpp"
#include "generator/mesh_files/msh_file.hpp"
#include "generator/mesh_files/tetgen_file.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heartgen::mesh_files {
namespace {

namespace fs = std::filesystem;

struct Ending {
  std::string_view text;
  UnstructuredData (*read)(const fs::path& path);
};

constexpr std::array<Ending, 15> endings{{{".vtu", &adapters::read_unstructured},
                                          {".vtk", &adapters::read_unstructured},
                                          {".msh", &read_msh},
                                          {".pts", &read_carp},
                                          {".elem", &read_carp},
                                          {".lon", &read_carp},
                                          {".bpts", &read_carp},
                                          {".belem", &read_carp},
                                          {".blon", &read_carp},
                                          {".node", &read_tetgen},
                                          {".ele", &read_tetgen},
                                          {".face", &read_tetgen},
                                          {".ortho", &read_tetgen},
                                          {".mesh", &read_medit},
                                          {".meshb", &read_medit}}};

const Ending* ending_of(const fs::path& path) {
  const auto* found = std::find_if(endings.begin(), endings.end(),
                                   [text = path.extension().string()](const auto& e) { return e.text == text; });
  return found == endings.end() ? nullptr : found;
}

/// Names that programs give to the array of regions, ours first.
constexpr std::array label_names{"region",    "gmsh:physical",    "CellEntityIds",  "material",
                                 "medit:ref", "elemTag",          "tags",           "tag",
                                 "attribute", "gmsh:geometrical", "PhysicalGroups", "label"};

bool are_labels(const std::vector<double>& values) {
  constexpr double most = std::numeric_limits<std::int32_t>::max();
  return std::all_of(values.begin(), values.end(), [](double v) { return v == std::round(v) && std::abs(v) <= most; });
}

std::vector<std::string> names_without_place(const UnstructuredData& mesh) {
  if (mesh.names.empty()) return {};
  std::string text;
  for (const auto& [of, name] : mesh.names)
    text += fmt::format("{}{} \"{}\"", text.empty() ? "" : ", ", of.second, name);
  return {"VTK's files have no place for the names of labels: " + text};
}

}  // namespace

bool is_mesh_name(const fs::path& path) { return ending_of(path) != nullptr; }

UnstructuredData read_any_mesh(const fs::path& path) {
  const auto* ending = ending_of(path);
  if (!ending)
    throw UserError(
        "is of no known kind", path.string(),
        "give a mesh of VTK (.vtu, .vtk), gmsh (.msh), openCARP (.pts, .bpts), TetGen or Chaste (.node), or "
        "Medit (.mesh, .meshb)");
  return ending->read(path);
}

void check_mesh_output(const fs::path& path) {
  const auto ending = path.extension();
  if (ending != ".vtu" && ending != ".vtk" && ending != ".msh")
    throw UserError("is of no known kind", path.string(), "use .vtu, .vtk or .msh");
  check_output(path);
}

std::vector<std::string> write_any_mesh(const fs::path& path, const UnstructuredData& mesh, const std::string& labels) {
  if (path.extension() == ".msh") {
    write_msh(path, mesh, labels);
    return {};
  }
  adapters::write_unstructured(path, mesh);
  return names_without_place(mesh);
}

std::string find_labels(const UnstructuredData& mesh, const std::string& wanted, const std::string& file) {
  const auto& arrays = mesh.cell_scalars;
  if (!wanted.empty() && !arrays.contains(wanted)) {
    std::vector<std::string> names;
    for (const auto& [name, values] : arrays) names.push_back(name);
    throw UserError(fmt::format("has no cell array \"{}\"", wanted), file,
                    names.empty() ? "it has no array of one number per cell"
                                  : fmt::format("its arrays: {}", fmt::join(names, ", ")));
  }
  std::string found = wanted;
  for (const auto* name : label_names)
    if (found.empty() && arrays.contains(name)) found = name;
  const auto on_faces = mesh.face_scalars.find(found);
  if (!found.empty() &&
      (!are_labels(arrays.at(found)) || (on_faces != mesh.face_scalars.end() && !are_labels(on_faces->second))))
    throw UserError(fmt::format("the array \"{}\" does not hold whole numbers", found), file,
                    "name the array with the regions: --region NAME");
  return found;
}

std::vector<std::int32_t> cell_labels(const UnstructuredData& mesh, const std::string& labels) {
  if (labels.empty()) return {};
  const auto& values = mesh.cell_scalars.at(labels);
  return {values.begin(), values.end()};
}

std::vector<std::int32_t> face_labels(const UnstructuredData& mesh, const std::string& labels) {
  const auto found = mesh.face_scalars.find(labels);
  if (found == mesh.face_scalars.end()) return std::vector<std::int32_t>(mesh.faces.size(), 0);
  return {found->second.begin(), found->second.end()};
}

double typical_unit_mm(const fs::path& path) {
  const auto* ending = ending_of(path);
  return ending && ending->read == &read_carp ? 0.001 : 1;
}

}  // namespace heartgen::mesh_files
