// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/improve_kept.hpp"

#include <utility>

#include "generator/mesh/sort_cells.hpp"
#include "generator/tetmesh/improve_mesh.hpp"

namespace heartgen::mesh {
namespace {

/// Takes away the nodes that no cell has.
void drop_unused_nodes(LabelledCells& mesh) {
  std::vector<std::int32_t> id(mesh.nodes_mm.size(), -1);
  for (const auto& cell : mesh.cells)
    for (const auto n : cell) id[static_cast<std::size_t>(n)] = 0;
  std::size_t kept = 0;
  for (std::size_t n = 0; n < id.size(); ++n) {
    if (id[n] < 0) continue;
    id[n] = static_cast<std::int32_t>(kept);
    mesh.nodes_mm[kept++] = mesh.nodes_mm[n];
  }
  mesh.nodes_mm.resize(kept);
  for (auto& cell : mesh.cells)
    for (auto& n : cell) n = id[static_cast<std::size_t>(n)];
}

}  // namespace

void improve_kept(LabelledCells& mesh, std::int32_t first_dropped_label) {
  LabelledCells kept, result;
  result.nodes_mm = mesh.nodes_mm;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const bool is_kept = mesh.label[c] > 0 && mesh.label[c] < first_dropped_label;
    auto& list = is_kept ? kept : result;
    list.cells.push_back(mesh.cells[c]);
    list.label.push_back(mesh.label[c]);
  }
  const auto better = tetmesh::improve_mesh(mesh.nodes_mm, kept.cells, kept.label, {});
  std::vector<std::int32_t> id;
  for (std::size_t n = 0; n < better.nodes_mm.size(); ++n) {
    if (better.old_node[n] >= 0) {
      id.push_back(better.old_node[n]);
      result.nodes_mm[static_cast<std::size_t>(id.back())] = better.nodes_mm[n];
    } else {
      id.push_back(static_cast<std::int32_t>(result.nodes_mm.size()));
      result.nodes_mm.push_back(better.nodes_mm[n]);
    }
  }
  for (std::size_t c = 0; c < better.cells.size(); ++c) {
    Cell cell = better.cells[c];
    for (auto& n : cell) n = id[static_cast<std::size_t>(n)];
    result.cells.push_back(cell);
    result.label.push_back(better.region[c]);
  }
  mesh = std::move(result);
  drop_unused_nodes(mesh);
  sort_cells(mesh.nodes_mm, mesh.cells, mesh.label);
}

}  // namespace heartgen::mesh
