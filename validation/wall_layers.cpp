// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/wall_layers.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "model/labels.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::validation {
namespace {

struct Wall {
  Region region;
  std::string_view endocardium;
  std::size_t side;  // of the heart
};
constexpr std::array<Wall, 4> walls{{{Region::lv_myocardium, "lv_endocardium", 0},
                                     {Region::la_wall, "la_endocardium", 0},
                                     {Region::rv_myocardium, "rv_endocardium", 1},
                                     {Region::ra_wall, "ra_endocardium", 1}}};
constexpr std::array<std::array<std::string_view, 3>, 2> far_sides{
    {{"epicardium", "rv_endocardium", "ra_endocardium"}, {"epicardium", "lv_endocardium", "la_endocardium"}}};

bool is_wall(std::int32_t region) {
  return is_myocardium(static_cast<Region>(region)) && static_cast<Region>(region) != Region::papillary;
}

/// Neighbours of each node along edges of wall cells: those of node n are node[first[n]] to node[first[n + 1] - 1].
struct Neighbours {
  std::vector<std::size_t> first;
  std::vector<std::int32_t> node;
};

Neighbours neighbours_in_walls(const TetMesh& mesh) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!is_wall(mesh.region[c])) continue;
    for (const auto a : mesh.cells[c])
      for (const auto b : mesh.cells[c])
        if (a != b) edges.emplace_back(a, b);
  }
  sort_unique(edges);
  Neighbours result{std::vector<std::size_t>(mesh.nodes_mm.size() + 1, 0), {}};
  result.node.reserve(edges.size());
  for (const auto& [a, b] : edges) {
    ++result.first[static_cast<std::size_t>(a) + 1];
    result.node.push_back(b);
  }
  for (std::size_t n = 1; n < result.first.size(); ++n) result.first[n] += result.first[n - 1];
  return result;
}

std::vector<bool> nodes_on(const TetMesh& mesh, std::span<const std::string_view> surfaces) {
  std::vector<std::int32_t> tags;
  for (const auto name : surfaces) tags.push_back(*surface_from_name(name));
  std::vector<bool> on(mesh.nodes_mm.size(), false);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (std::find(tags.begin(), tags.end(), mesh.surface[f]) != tags.end())
      for (const auto n : mesh.faces[f]) on[static_cast<std::size_t>(n)] = true;
  return on;
}

constexpr std::int32_t unreached = -1;

/// Edges from each node to the nearest of `goals`.
std::vector<std::int32_t> edges_to(const std::vector<bool>& goals, const Neighbours& neighbours) {
  std::vector<std::int32_t> edges(goals.size(), unreached), queue;
  for (std::size_t n = 0; n < goals.size(); ++n)
    if (goals[n]) {
      edges[n] = 0;
      queue.push_back(static_cast<std::int32_t>(n));
    }
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const auto n = static_cast<std::size_t>(queue[next]);
    for (auto i = neighbours.first[n]; i < neighbours.first[n + 1]; ++i) {
      auto& reached = edges[static_cast<std::size_t>(neighbours.node[i])];
      if (reached != unreached) continue;
      reached = edges[n] + 1;
      queue.push_back(neighbours.node[i]);
    }
  }
  return edges;
}

/// A third of the area of each face of the endocardium that has a cell of the wall, on each of its nodes.
std::vector<double> areas_at_nodes(const TetMesh& mesh, const Wall& wall) {
  std::vector<bool> in_wall(mesh.nodes_mm.size(), false);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(wall.region))
      for (const auto n : mesh.cells[c]) in_wall[static_cast<std::size_t>(n)] = true;
  const auto endocardium = *surface_from_name(wall.endocardium);
  std::vector<double> area(mesh.nodes_mm.size(), 0);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& face = mesh.faces[f];
    const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(face[i])]; };
    if (mesh.surface[f] != endocardium ||
        !std::all_of(face.begin(), face.end(), [&](std::int32_t n) { return in_wall[static_cast<std::size_t>(n)]; }))
      continue;
    for (const auto n : face) area[static_cast<std::size_t>(n)] += norm(cross(at(1) - at(0), at(2) - at(0))) / 6;
  }
  return area;
}

WallLayers summary(const std::vector<double>& area, const std::vector<std::int32_t>& layers) {
  std::map<std::int32_t, double> area_of_count;
  WallLayers result;
  for (std::size_t n = 0; n < area.size(); ++n)
    if (area[n] > 0 && layers[n] > 0) {
      area_of_count[layers[n]] += area[n];
      result.area_mm2 += area[n];
    }
  double below = 0;
  for (const auto& [count, share] : area_of_count) {
    const double up_to = below + share;
    if (below < 0.05 * result.area_mm2 && up_to >= 0.05 * result.area_mm2) result.p5 = count;
    if (below < 0.5 * result.area_mm2 && up_to >= 0.5 * result.area_mm2) result.median = count;
    if (count < 2) result.below_two = up_to / result.area_mm2;
    below = up_to;
  }
  return result;
}

}  // namespace

std::map<std::int32_t, WallLayers> wall_layers(const TetMesh& mesh) {
  std::map<std::int32_t, WallLayers> result;
  if (std::none_of(mesh.region.begin(), mesh.region.end(), is_wall)) return result;
  const auto neighbours = neighbours_in_walls(mesh);
  std::array<std::vector<std::int32_t>, 2> layers;
  for (std::size_t side = 0; side < layers.size(); ++side)
    layers[side] = edges_to(nodes_on(mesh, far_sides[side]), neighbours);
  for (const auto& wall : walls) {
    const auto found = summary(areas_at_nodes(mesh, wall), layers[wall.side]);
    if (found.area_mm2 > 0) result[tag(wall.region)] = found;
  }
  return result;
}

}  // namespace heartgen::validation
