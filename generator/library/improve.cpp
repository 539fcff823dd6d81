// SPDX-License-Identifier: GPL-3.0-or-later
#include <heartgen/improve.hpp>
#include <utility>

#include "generator/mesh_files/any_mesh.hpp"
#include "generator/tetmesh/carry_mesh.hpp"

namespace heartgen {
namespace {

constexpr const char* label_array = "region";

/// The members that are carried along, with the names that they have in files.
template <class Take>
void for_fields(Take&& take) {
  take("fiber", &FiberField::fiber);
  take("sheet", &FiberField::sheet);
  take("sheet_normal", &FiberField::sheet_normal);
}

UnstructuredData data_of(const TetMesh& mesh) {
  UnstructuredData data;
  data.points = mesh.nodes_mm;
  data.tets = mesh.cells;
  data.faces = mesh.faces;
  data.cell_scalars[label_array] = {mesh.region.begin(), mesh.region.end()};
  data.face_scalars[label_array] = {mesh.surface.begin(), mesh.surface.end()};
  data.integers.insert(label_array);
  for_fields([&](const char* name, auto member) {
    if (!(mesh.node_fibers.*member).empty()) data.point_vectors[name] = mesh.node_fibers.*member;
    if (!(mesh.cell_fibers.*member).empty()) data.cell_vectors[name] = mesh.cell_fibers.*member;
  });
  if (!mesh.fiber_source.empty()) {
    data.point_scalars["fiber_source"] = {mesh.fiber_source.begin(), mesh.fiber_source.end()};
    data.integers.insert("fiber_source");
  }
  return data;
}

/// Nodes of surfaces that did not change are there under other numbers.
std::vector<Rim> kept_rims(const std::vector<Rim>& rims, const tetmesh::ImprovedMesh& better, std::size_t old_count) {
  std::vector<std::int32_t> new_node(old_count, -1);
  for (std::size_t n = 0; n < better.old_node.size(); ++n)
    if (better.old_node[n] >= 0) new_node[static_cast<std::size_t>(better.old_node[n])] = static_cast<std::int32_t>(n);
  std::vector<Rim> kept = rims;
  for (auto& rim : kept)
    for (auto& node : rim.nodes) node = new_node[static_cast<std::size_t>(node)];
  return kept;
}

TetMesh mesh_of(UnstructuredData data) {
  TetMesh mesh;
  mesh.nodes_mm = std::move(data.points);
  mesh.cells = std::move(data.tets);
  mesh.faces = std::move(data.faces);
  for (const double tag : data.cell_scalars[label_array]) mesh.region.push_back(static_cast<std::int32_t>(tag));
  for (const double tag : data.face_scalars[label_array]) mesh.surface.push_back(static_cast<std::int32_t>(tag));
  for_fields([&](const char* name, auto member) {
    mesh.node_fibers.*member = std::move(data.point_vectors[name]);
    mesh.cell_fibers.*member = std::move(data.cell_vectors[name]);
  });
  for (const double source : data.point_scalars["fiber_source"])
    mesh.fiber_source.push_back(static_cast<std::uint8_t>(source));
  return mesh;
}

}  // namespace

UnstructuredData improved(UnstructuredData mesh, const std::string& labels, const ImproveSettings& settings) {
  const auto ids = tetmesh::take_out_ids(mesh, labels);
  const auto better = tetmesh::improve_mesh(mesh.points, mesh.tets, mesh_files::cell_labels(mesh, labels), settings);
  return tetmesh::carried_mesh(mesh, labels, ids, better);
}

TetMesh improved(const TetMesh& mesh, const ImproveSettings& settings) {
  const auto better = tetmesh::improve_mesh(mesh.nodes_mm, mesh.cells, mesh.region, settings);
  TetMesh result = mesh_of(tetmesh::carried_mesh(data_of(mesh), label_array, {}, better));
  if (better.is_fixed) result.rims = kept_rims(mesh.rims, better, mesh.nodes_mm.size());
  result.names = mesh.names;
  return result;
}

}  // namespace heartgen
