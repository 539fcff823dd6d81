// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/carry_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "generator/mesh_files/any_mesh.hpp"
#include "generator/mesh_files/surface_faces.hpp"
#include "generator/tetmesh/carry_data.hpp"
#include "generator/tetmesh/orient.hpp"
#include "model/fiber_names.hpp"
#include "model/mesh_queries/face_tree.hpp"

namespace heartgen::tetmesh {
namespace {

// ---- ids ----

bool counts_up(const std::vector<double>& values) {
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] != values[i - 1] + 1) return false;
  return true;
}

bool is_of_another_mesh(const std::string& name) {
  return name.find("riginal") != std::string::npos;  // vtkOriginalPointIds
}

std::vector<double> counted_from(double first, std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = first + static_cast<double>(i);
  return values;
}

// ---- triangles ----

template <class T>
std::vector<T> picked(const std::vector<T>& values, const std::vector<std::int32_t>& from) {
  std::vector<T> result;
  result.reserve(from.size());
  for (const auto i : from) result.push_back(values[static_cast<std::size_t>(i)]);
  return result;
}

template <class T>
std::map<std::string, std::vector<T>> picked(const std::map<std::string, std::vector<T>>& arrays,
                                             const std::vector<std::int32_t>& from) {
  std::map<std::string, std::vector<T>> result;
  for (const auto& [name, values] : arrays) result[name] = picked(values, from);
  return result;
}

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

/// Triangles of the new mesh and the old ones that they come from.
struct CarriedFaces {
  std::vector<Face> faces;
  std::vector<std::int32_t> from;
};

/// Surfaces and interfaces have the faces that they had; of others there may be nothing left.
CarriedFaces kept_faces(const UnstructuredData& old, const ImprovedMesh& improved) {
  std::vector<std::int32_t> id(old.points.size(), -1);
  for (std::size_t n = 0; n < improved.old_node.size(); ++n)
    if (improved.old_node[n] >= 0) id[static_cast<std::size_t>(improved.old_node[n])] = static_cast<std::int32_t>(n);
  std::vector<Face> there;
  for (const auto& cell : improved.cells)
    for (std::size_t out = 0; out < 4; ++out)
      there.push_back(sorted({cell[(out + 1) % 4], cell[(out + 2) % 4], cell[(out + 3) % 4]}));
  std::sort(there.begin(), there.end());
  CarriedFaces carried;
  for (std::size_t f = 0; f < old.faces.size(); ++f) {
    Face face = old.faces[f];
    for (auto& n : face) n = id[static_cast<std::size_t>(n)];
    if (face[0] < 0 || face[1] < 0 || face[2] < 0 || !std::binary_search(there.begin(), there.end(), sorted(face)))
      continue;
    carried.faces.push_back(face);
    carried.from.push_back(static_cast<std::int32_t>(f));
  }
  return carried;
}

using RegionPair = std::pair<std::int32_t, std::int32_t>;

RegionPair regions_beside(const mesh_files::SurfaceFace& face, const std::vector<std::int32_t>& region) {
  const auto of = [&](std::int32_t cell) {
    return cell < 0         ? std::numeric_limits<std::int32_t>::max()
           : region.empty() ? 1
                            : region[static_cast<std::size_t>(cell)];
  };
  return std::minmax(of(face.cell), of(face.other));
}

Vec3 normal_of(const std::vector<Vec3>& points, const Face& f) {
  const auto at = [&](std::size_t i) { return points[static_cast<std::size_t>(f[i])]; };
  return cross(at(1) - at(0), at(2) - at(0));
}

/// Where surfaces moved: each new face takes the triangle of the nearest old face between the same regions, if it had
/// one.
CarriedFaces nearest_faces(const UnstructuredData& old, const std::vector<Cell>& old_cells,
                           const std::vector<std::int32_t>& old_region, const ImprovedMesh& improved) {
  std::map<Face, std::int32_t> triangle;
  for (std::size_t f = 0; f < old.faces.size(); ++f)
    triangle.emplace(sorted(old.faces[f]), static_cast<std::int32_t>(f));
  std::vector<Face> faces;
  std::vector<RegionPair> beside;
  std::vector<std::int32_t> label_from;
  for (const auto& face : mesh_files::surface_faces(old_cells, old_region)) {
    faces.push_back(face.nodes);
    beside.push_back(regions_beside(face, old_region));
    const auto found = triangle.find(sorted(face.nodes));
    label_from.push_back(found == triangle.end() ? -1 : found->second);
  }
  const auto tree = mesh_queries::make_face_tree(old.points, faces);
  CarriedFaces carried;
  for (const auto& face : mesh_files::surface_faces(improved.cells, improved.region)) {
    Vec3 middle;
    for (const auto n : face.nodes) middle += improved.nodes_mm[static_cast<std::size_t>(n)] / 3;
    const auto pair = regions_beside(face, improved.region);
    const auto near = mesh_queries::nearest_face(tree, middle, std::numeric_limits<double>::max(), [&](std::int32_t f) {
      return beside[static_cast<std::size_t>(f)] == pair;
    });
    const auto from = near.face < 0 ? -1 : label_from[static_cast<std::size_t>(near.face)];
    if (from < 0) continue;
    Face nodes = face.nodes;
    if (dot(normal_of(improved.nodes_mm, nodes), normal_of(old.points, old.faces[static_cast<std::size_t>(from)])) < 0)
      std::swap(nodes[1], nodes[2]);
    carried.faces.push_back(nodes);
    carried.from.push_back(from);
  }
  return carried;
}

void carry_faces(const UnstructuredData& old, const std::vector<Cell>& old_cells, const std::string& labels,
                 const ImprovedMesh& improved, UnstructuredData& result) {
  if (old.faces.empty()) return;
  auto carried = improved.is_fixed ? kept_faces(old, improved)
                                   : nearest_faces(old, old_cells, mesh_files::cell_labels(old, labels), improved);
  if (improved.is_fixed && carried.faces.size() < old.faces.size())
    result.remarks.push_back(fmt::format("left out: {} of {} triangles, inside a region, that are faces no longer",
                                         old.faces.size() - carried.faces.size(), old.faces.size()));
  if (!improved.is_fixed)
    result.remarks.push_back(fmt::format("{} triangles became {} of the new surfaces; others, inside regions, are gone",
                                         old.faces.size(), carried.faces.size()));
  result.faces = std::move(carried.faces);
  result.face_scalars = picked(old.face_scalars, carried.from);
  result.face_vectors = picked(old.face_vectors, carried.from);
  result.face_tensors = picked(old.face_tensors, carried.from);
}

// ---- arrays on points ----

std::string name_of_axis(const std::map<std::string, std::vector<Vec3>>& vectors, AxisName axis) {
  std::string found;
  for (const auto& [name, values] : vectors) {
    if (axis_name(name) != axis) continue;
    if (!found.empty()) return {};  // of which frame?
    found = name;
  }
  return found;
}

void straighten_frames(std::map<std::string, std::vector<Vec3>>& vectors) {
  const auto fiber = name_of_axis(vectors, AxisName::fiber), sheet = name_of_axis(vectors, AxisName::sheet),
             normal = name_of_axis(vectors, AxisName::sheet_normal);
  if (!fiber.empty() && !sheet.empty() && !normal.empty())
    straighten(vectors.at(fiber), vectors.at(sheet), vectors.at(normal));
}

void carry_point_arrays(const UnstructuredData& old, const std::vector<NodeSource>& from, UnstructuredData& result) {
  for (const auto& [name, values] : old.point_scalars) result.point_scalars[name] = carried(values, from);
  for (const auto& [name, values] : old.point_vectors)
    result.point_vectors[name] = axis_name(name) == AxisName::none ? carried(values, from) : carried_axes(values, from);
  for (const auto& [name, values] : old.point_tensors) result.point_tensors[name] = carried(values, from);
  straighten_frames(result.point_vectors);
}

}  // namespace

Ids take_out_ids(UnstructuredData& mesh, const std::string& labels) {
  Ids ids;
  std::set<std::string> gone;
  const auto sort_out = [&](std::map<std::string, std::vector<double>>& arrays, std::set<std::string>& anew) {
    for (auto array = arrays.begin(); array != arrays.end();) {
      const auto& [name, values] = *array;
      const bool is_id = name != labels && are_ids(values);
      const bool may_count = is_id && counts_up(values) && !is_of_another_mesh(name);
      if (may_count) anew.insert(name);
      if (is_id && !may_count) gone.insert(name);
      array = is_id && !may_count ? arrays.erase(array) : std::next(array);
    }
  };
  sort_out(mesh.point_scalars, ids.point);
  sort_out(mesh.cell_scalars, ids.cell);
  for (const auto& name : gone) mesh.face_scalars.erase(name);
  std::set<std::string> anew = ids.point;
  anew.insert(ids.cell.begin(), ids.cell.end());
  if (!anew.empty()) mesh.remarks.push_back(fmt::format("ids made anew: {}", fmt::join(anew, ", ")));
  if (!gone.empty())
    mesh.remarks.push_back(
        fmt::format("left out: {} (they number nodes or cells of the given mesh)", fmt::join(gone, ", ")));
  return ids;
}

UnstructuredData carried_mesh(const UnstructuredData& old, const std::string& labels, const Ids& ids,
                              const ImprovedMesh& improved) {
  const auto cells = oriented_cells(old.points, old.tets);
  UnstructuredData result;
  result.points = improved.nodes_mm;
  result.tets = improved.cells;
  result.integers = old.integers;
  result.names = old.names;
  result.remarks = old.remarks;
  carry_point_arrays(old, node_sources(old.points, cells, improved), result);
  const auto from = cell_sources(old.points, cells, mesh_files::cell_labels(old, labels), improved);
  result.cell_scalars = picked(old.cell_scalars, from);
  result.cell_vectors = picked(old.cell_vectors, from);
  result.cell_tensors = picked(old.cell_tensors, from);
  if (!labels.empty()) result.cell_scalars[labels] = {improved.region.begin(), improved.region.end()};
  carry_faces(old, cells, labels, improved, result);
  for (const auto& name : ids.point)
    result.point_scalars[name] = counted_from(old.point_scalars.at(name).front(), result.points.size());
  for (const auto& name : ids.cell) {
    const auto on_faces = old.face_scalars.find(name);
    const bool has_faces = on_faces != old.face_scalars.end() && !on_faces->second.empty();
    const double first = old.cell_scalars.at(name).front();
    const double start = has_faces ? std::min(first, on_faces->second.front()) : first;
    if (has_faces) result.face_scalars[name] = counted_from(start, result.faces.size());
    result.cell_scalars[name] =
        counted_from(start + static_cast<double>(has_faces ? result.faces.size() : 0), result.tets.size());
  }
  return result;
}

}  // namespace heartgen::tetmesh
