// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/cavity_checks.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "model/labels.hpp"
#include "model/sort_unique.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::validation {
namespace {

using Edge = std::pair<std::int32_t, std::int32_t>;

template <class Visit>
void for_edges(const Face& face, const Visit& visit) {
  for (std::size_t i = 0; i < 3; ++i) visit(Edge{face[i], face[(i + 1) % 3]});
}

/// Directed edges that occur more than once.
std::int64_t turned_edges(const std::vector<Face>& faces) {
  std::vector<Edge> edges;
  for (const auto& face : faces) for_edges(face, [&](const Edge& edge) { edges.push_back(edge); });
  const auto all = static_cast<std::int64_t>(edges.size());
  sort_unique(edges);
  return all - static_cast<std::int64_t>(edges.size());
}

std::int64_t cap_nodes_off_rims(const Cavity& cavity) {
  std::vector<Edge> walls;
  std::set<std::int32_t> of_caps, of_rims;
  for (std::size_t f = 0; f < cavity.faces.size(); ++f) {
    if (is_cap(cavity.surface[f]))
      of_caps.insert(cavity.faces[f].begin(), cavity.faces[f].end());
    else
      for_edges(cavity.faces[f], [&](const Edge& e) { walls.emplace_back(std::minmax(e.first, e.second)); });
  }
  std::sort(walls.begin(), walls.end());
  for (std::size_t e = 0; e < walls.size();) {
    std::size_t next = e;
    while (next < walls.size() && walls[next] == walls[e]) ++next;
    if (next == e + 1) of_rims.insert({walls[e].first, walls[e].second});
    e = next;
  }
  return std::count_if(of_caps.begin(), of_caps.end(), [&](std::int32_t node) { return !of_rims.contains(node); });
}

/// Of a region's cells, in the mesh that holds blood; 0: none does.
double blood_mm3(const std::map<std::string, TetMesh>& meshes, std::int32_t region) {
  for (const char* name : {"chambers", "torso"}) {
    const auto found = meshes.find(name);
    if (found == meshes.end()) continue;
    const TetMesh& mesh = found->second;
    double volume = 0;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c)
      if (mesh.region[c] == region) volume += cell_volume_mm3(mesh, mesh.cells[c]);
    return volume;
  }
  return 0;
}

}  // namespace

Report check_cavities(const std::map<std::string, TetMesh>& meshes) {
  constexpr double mm3_per_ml = 1000;
  Report report;
  for (const auto& [name, mesh] : meshes)
    for (const auto& cavity : mesh.cavities) {
      const auto add = [&, scope = name + "/" + cavity.name](const char* metric, double value, const char* unit) {
        report.push_back({"cavities", scope, metric, value, unit, {}, {}});
      };
      const auto count = [&](const char* metric, std::int64_t n) { add(metric, static_cast<double>(n), "count"); };
      const auto topology = surface_topology(cavity.faces);
      count("open_edges", topology.open_edges);
      count("non_manifold_edges", topology.non_manifold_edges);
      count("non_manifold_vertices", topology.non_manifold_vertices);
      count("turned_edges", turned_edges(cavity.faces));
      std::set<std::int32_t> caps;
      for (const auto tag : cavity.surface)
        if (is_cap(tag)) caps.insert(tag);
      count("caps", static_cast<std::int64_t>(caps.size()));
      count("cap_nodes_off_rims", cap_nodes_off_rims(cavity));
      const double volume = enclosed_volume_mm3(mesh.nodes_mm, cavity.faces);
      add("volume", volume / mm3_per_ml, "ml");
      if (const double blood = blood_mm3(meshes, cavity.region); blood > 0)
        add("volume_difference", 100 * (volume / blood - 1), "%");
    }
  return report;
}

}  // namespace heartgen::validation
