// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <heartgen/meshes.hpp>
#include <limits>
#include <map>
#include <set>

#include "exporters/registry.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "generator/fibers/frame.hpp"
#include "generator/mesh_files/any_mesh.hpp"
#include "generator/mesh_files/surface_faces.hpp"
#include "generator/tetmesh/orient.hpp"
#include "model/fiber_names.hpp"
#include "model/mesh_queries/feature_curves.hpp"

namespace heartgen {
namespace {

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

// ---- faces ----

constexpr std::int32_t outside = std::numeric_limits<std::int32_t>::min();  // no region's number

/// Numbers above all that the file uses, one for every two regions that meet.
struct FreeLabels {
  std::int32_t next;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> of_regions{};

  std::int32_t at(std::int32_t a, std::int32_t b) {
    const auto [place, is_new] = of_regions.try_emplace(std::minmax(a, b), next);
    next += is_new;
    return place->second;
  }
};

std::int32_t above_all(const std::vector<std::int32_t>& regions, const std::vector<std::int32_t>& labels) {
  std::int32_t most = 0;
  for (const auto* tags : {&regions, &labels})
    for (const auto tag : *tags) most = std::max(most, tag);
  return most + 1;
}

void name_free_labels(const FreeLabels& free, TetMesh& mesh) {
  for (const auto& [regions, label] : free.of_regions) {
    const auto name = [&](std::int32_t tag) { return mesh.names.at({3, tag}); };
    mesh.names[{2, label}] = regions.first == outside ? "boundary_of_" + name(regions.second)
                                                      : name(regions.first) + "_" + name(regions.second);
  }
}

/// Every face once: of surfaces and interfaces as the cells show them, then what the file labels inside of regions.
void set_faces(const UnstructuredData& data, const std::vector<std::int32_t>& labels, MeshFile& own) {
  TetMesh& mesh = own.mesh;
  std::map<Face, std::int32_t> label_of;
  for (std::size_t f = 0; f < data.faces.size(); ++f)
    if (labels[f] != 0) label_of.emplace(sorted(data.faces[f]), labels[f]);
  const auto region = [&](std::int32_t cell) {
    return cell < 0 ? outside : mesh.region[static_cast<std::size_t>(cell)];
  };
  FreeLabels free{above_all(mesh.region, labels)};
  for (const auto& face : mesh_files::surface_faces(mesh.cells, mesh.region)) {
    const auto known = label_of.extract(sorted(face.nodes));
    mesh.faces.push_back(face.nodes);
    mesh.surface.push_back(known ? known.mapped() : free.at(region(face.cell), region(face.other)));
  }
  std::vector<Face> all;
  for (const auto& cell : mesh.cells)
    for (std::size_t out = 0; out < 4 && !label_of.empty(); ++out)
      all.push_back(sorted({cell[(out + 1) % 4], cell[(out + 2) % 4], cell[(out + 3) % 4]}));
  std::sort(all.begin(), all.end());
  std::size_t loose = 0;
  for (const auto& [face, label] : label_of) {
    const bool is_there = std::binary_search(all.begin(), all.end(), face);
    loose += !is_there;
    if (!is_there) continue;
    mesh.faces.push_back(face);
    mesh.surface.push_back(label);
  }
  if (loose > 0) own.remarks.push_back(fmt::format("left out: {} triangles that are no faces of tetrahedra", loose));
  for (const auto tag : labels)
    if (tag != 0) mesh.names.try_emplace({2, tag}, fmt::format("surface_{}", tag));
  name_free_labels(free, mesh);
}

// ---- fibres ----

using Vectors = std::map<std::string, std::vector<Vec3>>;

const std::vector<Vec3>* find_axes(const Vectors& vectors, AxisName axis) {
  for (const auto& [name, values] : vectors)
    if (axis_name(name) == axis && !values.empty()) return &values;
  return nullptr;
}

/// Frames where there is a fibre; zero elsewhere. Empty without fibres.
FiberField frames_of(const Vectors& vectors, MeshFile& own) {
  const auto *fiber = find_axes(vectors, AxisName::fiber), *sheet = find_axes(vectors, AxisName::sheet);
  FiberField field;
  if (!fiber) return field;
  for (std::size_t i = 0; i < fiber->size(); ++i) {
    const Vec3& f = (*fiber)[i];
    const auto axes = f == Vec3{} ? fibers::MaterialAxes{} : fibers::material_axes(f, sheet ? (*sheet)[i] : Vec3{});
    field.fiber.push_back(axes.fiber);
    field.sheet.push_back(axes.sheet);
    field.sheet_normal.push_back(axes.sheet_normal);
  }
  if (!sheet) own.remarks.emplace_back("the file has no sheets: any directions across the fibres stand for them");
  return field;
}

void set_fibers(const UnstructuredData& data, MeshFile& own) {
  own.mesh.node_fibers = frames_of(data.point_vectors, own);
  own.mesh.cell_fibers = frames_of(data.cell_vectors, own);
  FiberField& cell = own.mesh.cell_fibers;
  if (!cell.fiber.empty() || own.mesh.node_fibers.fiber.empty()) return;
  cell = fibers::cell_frames(own.mesh, own.mesh.node_fibers);
  for (std::size_t c = 0; c < cell.fiber.size(); ++c)
    if (cell.fiber[c] == Vec3{}) cell.sheet[c] = cell.sheet_normal[c] = {};
}

/// What an export of its own kind has no place for.
void remark_on_arrays(const UnstructuredData& data, const std::string& labels, MeshFile& own) {
  std::set<std::string> names;
  for (const auto* arrays : {&data.point_scalars, &data.cell_scalars, &data.face_scalars})
    for (const auto& [name, values] : *arrays)
      if (name != labels) names.insert(name);
  for (const auto* arrays : {&data.point_vectors, &data.cell_vectors})
    for (const auto& [name, values] : *arrays)
      if (axis_name(name) == AxisName::none) names.insert(name);
  for (const auto* arrays : {&data.point_tensors, &data.cell_tensors})
    for (const auto& [name, values] : *arrays) names.insert(name);
  if (!names.empty()) own.remarks.push_back(fmt::format("left out: the arrays {}", fmt::join(names, ", ")));
}

/// Names go into file names and into files of other programs: letters, digits, '_', '-' and '.', no name twice.
void make_names_safe(MeshFile& own) {
  std::set<std::string> used;
  for (auto& [of, name] : own.mesh.names) {
    std::string safe = name;
    for (char& c : safe) {
      const bool is_plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
      if (!is_plain && c != '_' && c != '-' && c != '.') c = '_';
    }
    if (safe.empty() || used.contains(safe)) safe += fmt::format("_{}", of.second);
    while (!used.insert(safe).second) safe += "_2";
    if (safe != name) own.remarks.push_back(fmt::format("the group \"{}\" is called \"{}\"", name, safe));
    name = safe;
  }
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& path, const std::string& region, const std::string& unit) {
  const auto data = mesh_files::read_any_mesh(path);
  const auto labels = mesh_files::find_labels(data, region, path.string());
  const double scale = unit.empty() ? mesh_files::typical_unit_mm(path) : 1 / exporters::unit_scale(unit);
  MeshFile own;
  own.name = path.stem().string();
  own.remarks = data.remarks;
  TetMesh& mesh = own.mesh;
  mesh.nodes_mm = data.points;
  for (auto& node : mesh.nodes_mm) node *= scale;
  mesh.cells = tetmesh::oriented_cells(data.points, data.tets);
  mesh.region =
      labels.empty() ? std::vector<std::int32_t>(mesh.cells.size(), 1) : mesh_files::cell_labels(data, labels);
  mesh.names = data.names;
  for (const auto tag : mesh.region) mesh.names.try_emplace({3, tag}, fmt::format("region_{}", tag));
  set_faces(data, mesh_files::face_labels(data, labels), own);
  make_names_safe(own);
  set_fibers(data, own);
  remark_on_arrays(data, labels, own);
  return own;
}

std::vector<std::filesystem::path> write_mesh(const std::filesystem::path& path, const TetMesh& mesh) {
  const std::string name = path.stem().string(), kind = path.extension().string();
  const std::string format = kind == ".msh" ? "msh-ascii" : kind.substr(std::min<std::size_t>(1, kind.size()));
  auto files = exporters::export_mesh(format, mesh, name, path.has_parent_path() ? path.parent_path() : ".");
  files.push_back(std::filesystem::path(path).replace_filename(name + "_curves.vtp"));
  adapters::write_curves(files.back(), mesh, mesh_queries::feature_curves(mesh));
  return files;
}

}  // namespace heartgen
