// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/node_walls.hpp"

#include "model/labels.hpp"

namespace heartgen::pipeline {

std::vector<std::int32_t> regions_of_nodes(const TetMesh& mesh) {
  std::vector<std::int32_t> region(mesh.nodes_mm.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto node : mesh.cells[c]) {
      auto& r = region[static_cast<std::size_t>(node)];
      if (r != tag(Region::rv_myocardium)) r = mesh.region[c];
    }
  return region;
}

std::vector<std::int32_t> regions_of_own_nodes(const TetMesh& mesh) {
  auto region = regions_of_nodes(mesh);
  const auto all = region;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (const auto node : mesh.cells[c])
      if (const auto n = static_cast<std::size_t>(node); mesh.region[c] != all[n]) region[n] = 0;
  return region;
}

}  // namespace heartgen::pipeline
