// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl/filesystem.h>

#include <heartgen/checks.hpp>
#include <heartgen/export.hpp>
#include <heartgen/fibers.hpp>
#include <heartgen/improve.hpp>
#include <heartgen/labels.hpp>
#include <heartgen/mesh_labels.hpp>
#include <heartgen/meshes.hpp>

#include "arrays.hpp"
#include "module.hpp"

namespace heartgen::python {
namespace {

using MeshClass = py::class_<TetMesh, std::shared_ptr<TetMesh>>;

/// A property that shows a member where it lies, without a copy; None where it is empty.
template <class T, class Get>
void add_view(MeshClass& mesh_class, const char* name, py::ssize_t width, Get get) {
  mesh_class.def_property_readonly(name, [get, width](const py::object& self) -> py::object {
    auto& values = get(py::cast<TetMesh&>(self));
    if (values.empty()) return py::none();
    const auto count = static_cast<py::ssize_t>(values.size());
    const auto shape = width == 1 ? std::vector<py::ssize_t>{count} : std::vector<py::ssize_t>{count, width};
    return py::array_t<T>(shape, reinterpret_cast<const T*>(values.data()), self);
  });
}

/// Names of the tags that occur, with these.
py::dict names_of(const TetMesh& mesh, int dimension, const std::vector<std::int32_t>& tags) {
  std::map<std::int32_t, std::string> names;
  for (const auto tag : tags)
    if (!names.contains(tag)) {
      const auto own = mesh.names.find({dimension, tag});
      names[tag] = own != mesh.names.end() ? own->second : dimension == 3 ? region_name(tag) : surface_name(tag);
    }
  py::dict result;
  for (const auto& [tag, name] : names) result[py::str(name)] = tag;
  return result;
}

py::dict rims_of(const TetMesh& mesh) {
  py::dict rims;
  for (const auto& rim : mesh.rims)
    rims[py::str(rim.name)] = py::array_t<std::int32_t>(static_cast<py::ssize_t>(rim.nodes.size()), rim.nodes.data());
  return rims;
}

/// Throws UserError for arrays of other shapes, and for cells that name missing nodes.
std::shared_ptr<TetMesh> make_mesh(const Array<double>& points, const Array<std::int32_t>& cells,
                                   const Array<std::int32_t>& regions) {
  if (points.ndim() != 2 || points.shape(1) != 3)
    throw UserError("must have 3 columns", "points", "give x, y, z in mm");
  if (cells.ndim() != 2 || cells.shape(1) != 4) throw UserError("must have 4 columns", "cells", "give node ids from 0");
  if (regions.ndim() != 1 || regions.shape(0) != cells.shape(0))
    throw UserError("must have one number per cell", "regions", "give whole numbers");
  auto mesh = std::make_shared<TetMesh>();
  const auto* p = points.data();
  for (py::ssize_t n = 0; n < points.shape(0); ++n) mesh->nodes_mm.push_back({p[3 * n], p[3 * n + 1], p[3 * n + 2]});
  const auto* c = cells.data();
  for (py::ssize_t n = 0; n < cells.shape(0); ++n)
    mesh->cells.push_back({c[4 * n], c[4 * n + 1], c[4 * n + 2], c[4 * n + 3]});
  mesh->region.assign(regions.data(), regions.data() + regions.size());
  for (const auto& cell : mesh->cells)
    for (const auto node : cell)
      if (node < 0 || node >= points.shape(0))
        throw UserError("names a node that is not there", "cells", "count from 0");
  return mesh;
}

void add_mesh_class(py::module_& m) {
  MeshClass mesh(m, "TetMesh");
  mesh.def(py::init(&make_mesh));
  add_view<double>(
      mesh, "points", 3, [](TetMesh & t) -> auto& { return t.nodes_mm; });
  add_view<std::int32_t>(
      mesh, "cells", 4, [](TetMesh & t) -> auto& { return t.cells; });
  add_view<std::int32_t>(
      mesh, "regions", 1, [](TetMesh & t) -> auto& { return t.region; });
  add_view<std::int32_t>(
      mesh, "faces", 3, [](TetMesh & t) -> auto& { return t.faces; });
  add_view<std::int32_t>(
      mesh, "face_tags", 1, [](TetMesh & t) -> auto& { return t.surface; });
  add_view<double>(
      mesh, "fiber", 3, [](TetMesh & t) -> auto& { return t.node_fibers.fiber; });
  add_view<double>(
      mesh, "sheet", 3, [](TetMesh & t) -> auto& { return t.node_fibers.sheet; });
  add_view<double>(
      mesh, "sheet_normal", 3, [](TetMesh & t) -> auto& { return t.node_fibers.sheet_normal; });
  add_view<double>(
      mesh, "cell_fiber", 3, [](TetMesh & t) -> auto& { return t.cell_fibers.fiber; });
  add_view<double>(
      mesh, "cell_sheet", 3, [](TetMesh & t) -> auto& { return t.cell_fibers.sheet; });
  add_view<double>(
      mesh, "cell_sheet_normal", 3, [](TetMesh & t) -> auto& { return t.cell_fibers.sheet_normal; });
  add_view<std::uint8_t>(
      mesh, "fiber_source", 1, [](TetMesh & t) -> auto& { return t.fiber_source; });
  add_view<std::int32_t>(
      mesh, "parent_node", 1, [](TetMesh & t) -> auto& { return t.parent_node; });
  add_view<std::int32_t>(
      mesh, "parent_cell", 1, [](TetMesh & t) -> auto& { return t.parent_cell; });
  mesh.def_property_readonly("rims", &rims_of);
  mesh.def_property_readonly("region_names", [](const TetMesh& t) { return names_of(t, 3, t.region); });
  mesh.def_property_readonly("surface_names", [](const TetMesh& t) { return names_of(t, 2, t.surface); });
}

std::shared_ptr<TetMesh> shared(TetMesh&& mesh) { return std::make_shared<TetMesh>(std::move(mesh)); }

std::shared_ptr<TetMesh> mesh_of_labels(const Array<std::uint8_t>& array, const Geometry& g, const py::dict& given,
                                        bool walls) {
  MeshSettings settings;
  set_members(settings, given, "mesh_labels");
  const auto labels = volume_of(array, g);
  return unlocked([&] { return shared(walls ? mesh_walls(labels, settings) : mesh_labels(labels, settings)); });
}

py::tuple map_onto(const TetMesh& mesh, const Array<std::uint8_t>& array, const Geometry& g,
                   const std::string& landmarks, const std::string& atlas, const std::string& atlas_array,
                   const py::dict& given) {
  FiberSettings settings;
  set_members(settings, given, "map_fibers");
  const auto labels = volume_of(array, g);
  auto [mapped, result] = unlocked([&] {
    auto done = map_fibers(mesh, labels, parse_landmarks(landmarks, "landmarks"),
                           atlas.empty() ? standin_atlas() : read_fiber_atlas(atlas, atlas_array), settings);
    auto whole = shared(std::move(done.mesh));
    return std::pair{std::move(whole), std::move(done)};
  });
  py::list warnings;
  for (const auto& warning : result.warnings) warnings.append(warning.text);
  return py::make_tuple(mapped, result.atlas_overlap, result.min_jacobian, warnings);
}

std::shared_ptr<TetMesh> with_fibers_of(const TetMesh& from, const TetMesh& onto, double reach_mm) {
  auto mesh = shared(TetMesh(onto));
  auto carried = transfer_fibers(from, mesh->nodes_mm, mesh->cells, reach_mm);
  mesh->node_fibers = std::move(carried.node);
  mesh->cell_fibers = std::move(carried.cell);
  mesh->fiber_source = std::move(carried.source);
  return mesh;
}

py::list rows_of(const Report& report) {
  py::list rows;
  for (const auto& row : report)
    rows.append(py::make_tuple(row.scope, row.metric, row.value, row.unit, static_cast<int>(row.verdict())));
  return rows;
}

void add_work(py::module_& m) {
  using Unlocked = py::call_guard<py::gil_scoped_release>;
  m.def("mesh_labels", &mesh_of_labels);
  m.def(
      "improve",
      [](const TetMesh& mesh, double goal_deg, double slide_mm, std::int64_t budget) {
        return shared(improved(mesh, {.goal_deg = goal_deg, .slide_mm = slide_mm, .budget = budget}));
      },
      Unlocked());
  m.def("map_fibers", &map_onto);
  m.def("transfer", &with_fibers_of, Unlocked());
  m.def(
      "only_regions",
      [](const TetMesh& mesh, const std::vector<std::string>& names) {
        return shared(only_regions(mesh, regions_named(names)));
      },
      Unlocked());
  m.def("read_mesh", [](const std::string& path, const std::string& region, const std::string& unit) {
    auto file = unlocked([&] { return read_mesh(path, region, unit); });
    return py::make_tuple(shared(std::move(file.mesh)), file.name, file.remarks);
  });
  m.def(
      "write_mesh", [](const std::filesystem::path& path, const TetMesh& mesh) { return write_mesh(path, mesh); },
      Unlocked());
  m.def("check_mesh", [](const TetMesh& mesh, const std::string& name) {
    return rows_of(unlocked([&] { return check_mesh(MeshFile{name, mesh, {}}); }));
  });
}

}  // namespace

void add_meshes(py::module_& m) {
  add_mesh_class(m);
  add_work(m);
  py::list formats;
  for (const auto& format : export_formats())
    formats.append(py::make_tuple(std::string(format.name), std::string(format.description), std::string(format.unit)));
  m.attr("formats") = formats;
  m.def(
      "export_mesh",
      [](const std::string& format, const TetMesh& mesh, const std::string& name, const std::filesystem::path& folder,
         const std::string& unit) { return export_mesh(format, mesh, name, folder, unit); },
      py::call_guard<py::gil_scoped_release>());
}

}  // namespace heartgen::python
