// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/cavities.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <string_view>
#include <utility>

#include "generator/mesh/fill_loop.hpp"
#include "model/labels.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::mesh {
namespace {

constexpr std::array<std::pair<std::string_view, Region>, 4> chambers{{{"lv_cavity", Region::lv_blood},
                                                                       {"rv_cavity", Region::rv_blood},
                                                                       {"la_cavity", Region::la_blood},
                                                                       {"ra_cavity", Region::ra_blood}}};

// Faces of a positively oriented cell, normals outwards.
constexpr std::array<std::array<std::size_t, 3>, 4> face_corners{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

using Edge = std::pair<std::int32_t, std::int32_t>;

Face ascending(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

/// A face by its nodes, ascending, and as it is.
struct KeyedFace {
  Face key, face;
  bool operator<(const KeyedFace& other) const { return key < other.key; }
};

/// Faces of the cells with is_part(region) whose nodes are all marked (no marks: all), by their key.
template <class IsPart>
std::vector<KeyedFace> faces_of_cells(const TetMesh& mesh, const IsPart& is_part,
                                      const std::vector<std::uint8_t>& marks) {
  std::vector<KeyedFace> faces;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    if (!is_part(static_cast<Region>(mesh.region[c]))) continue;
    for (const auto& corners : face_corners) {
      const Cell& n = mesh.cells[c];
      const Face face{n[corners[0]], n[corners[1]], n[corners[2]]};
      if (marks.empty() || std::all_of(face.begin(), face.end(),
                                       [&](std::int32_t node) { return marks[static_cast<std::size_t>(node)] != 0; }))
        faces.push_back({ascending(face), face});
    }
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

/// Those that one cell alone has.
std::vector<KeyedFace> boundary_of(std::vector<KeyedFace> faces) {
  std::vector<KeyedFace> boundary;
  for (std::size_t f = 0; f < faces.size();) {
    std::size_t next = f + 1;
    while (next < faces.size() && faces[next].key == faces[f].key) ++next;
    if (next == f + 1) boundary.push_back(faces[f]);
    f = next;
  }
  return boundary;
}

/// Labels of the mesh's faces by their nodes, ascending.
std::map<Face, std::int32_t> labels_of(const TetMesh& mesh, const std::vector<KeyedFace>& boundary) {
  std::map<Face, std::int32_t> labels;
  for (const auto& face : boundary) labels[face.key] = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (const auto found = labels.find(ascending(mesh.faces[f])); found != labels.end())
      found->second = mesh.surface[f];
  return labels;
}

std::array<Edge, 3> edges_of(const Face& face) {
  return {Edge{face[0], face[1]}, Edge{face[1], face[2]}, Edge{face[2], face[0]}};
}

/// Faces that hang together through edges.
std::vector<std::vector<Face>> connected_parts(const std::vector<Face>& faces) {
  std::vector<std::pair<Edge, std::size_t>> sides;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const auto& edge : edges_of(faces[f])) sides.emplace_back(std::minmax(edge.first, edge.second), f);
  std::sort(sides.begin(), sides.end());
  std::vector<std::size_t> root(faces.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t f) {
    while (root[f] != f) f = root[f] = root[root[f]];
    return f;
  };
  for (std::size_t s = 0; s + 1 < sides.size(); ++s)
    if (sides[s].first == sides[s + 1].first) {
      const auto a = find(sides[s].second), b = find(sides[s + 1].second);
      root[std::max(a, b)] = std::min(a, b);
    }
  std::map<std::size_t, std::vector<Face>> parts;
  for (std::size_t f = 0; f < faces.size(); ++f) parts[find(f)].push_back(faces[f]);
  std::vector<std::vector<Face>> result;
  for (auto& [first, part] : parts) result.push_back(std::move(part));
  return result;
}

/// Edges that no face has the other way round, in the faces' direction.
std::multimap<std::int32_t, std::int32_t> open_edges(const std::vector<Face>& faces) {
  std::vector<Edge> edges;
  for (const auto& face : faces)
    for (const auto& edge : edges_of(face)) edges.push_back(edge);
  std::sort(edges.begin(), edges.end());
  std::multimap<std::int32_t, std::int32_t> open;
  for (const auto& [a, b] : edges)
    if (!std::binary_search(edges.begin(), edges.end(), Edge{b, a})) open.emplace(a, b);
  return open;
}

/// The open edges of faces as loops; one that comes back to a node is cut off there.
std::vector<std::vector<std::int32_t>> loops_of(const std::vector<Face>& faces) {
  auto open = open_edges(faces);
  std::vector<std::vector<std::int32_t>> loops;
  while (!open.empty()) {
    std::vector<std::int32_t> path{open.begin()->first};
    while (!path.empty()) {
      const auto next = open.find(path.back());
      if (next == open.end()) break;  // a dead end: the faces are no surface there
      const auto node = next->second;
      open.erase(next);
      const auto met = std::find(path.begin(), path.end(), node);
      if (met == path.end()) {
        path.push_back(node);
        continue;
      }
      loops.emplace_back(met, path.end());
      path.erase(met + 1, path.end());
      if (path.size() == 1 && open.find(node) == open.end()) break;
    }
  }
  std::erase_if(loops, [](const auto& loop) { return loop.size() < 3; });
  return loops;
}

double area_mm2(const TetMesh& mesh, const Face& face) {
  const auto at = [&](std::size_t i) { return mesh.nodes_mm[static_cast<std::size_t>(face[i])]; };
  return norm(cross(at(1) - at(0), at(2) - at(0))) / 2;
}

/// The surface that covers most of an opening.
std::int32_t surface_of(const TetMesh& mesh, const std::vector<Face>& opening,
                        const std::map<Face, std::int32_t>& labels) {
  std::map<std::int32_t, double> areas;
  for (const auto& face : opening) areas[labels.at(ascending(face))] += area_mm2(mesh, face);
  return std::max_element(areas.begin(), areas.end(), [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

Cavity find_cavity(const TetMesh& mesh, std::string_view name, Region blood) {
  Cavity cavity{std::string(name), tag(blood), {}, {}};
  const auto boundary = boundary_of(faces_of_cells(mesh, [&](Region r) { return r == blood; }, {}));
  std::vector<std::uint8_t> marks(mesh.nodes_mm.size(), 0);
  for (const auto& face : boundary)
    for (const auto node : face.face) marks[static_cast<std::size_t>(node)] = 1;
  const auto of_walls = faces_of_cells(mesh, &is_myocardium, marks);
  const auto labels = labels_of(mesh, boundary);
  std::vector<Face> openings;
  for (const auto& face : boundary) {
    const bool is_wall = std::binary_search(of_walls.begin(), of_walls.end(), face);
    if (!is_wall) {
      openings.push_back(face.face);
      continue;
    }
    cavity.faces.push_back(face.face);
    cavity.surface.push_back(labels.at(face.key));
  }
  if (cavity.faces.empty()) return cavity;
  std::vector<Edge> taken;
  for (const auto& face : cavity.faces)
    for (const auto& [a, b] : edges_of(face)) taken.emplace_back(std::minmax(a, b));
  sort_unique(taken);
  const auto is_taken = [&](std::int32_t a, std::int32_t b) {
    return std::binary_search(taken.begin(), taken.end(), Edge{a, b});
  };
  for (const auto& opening : connected_parts(openings)) {
    const auto cap = cap_tag(surface_of(mesh, opening, labels));
    for (const auto& loop : loops_of(opening))
      for (const auto& face : fill_loop(mesh.nodes_mm, loop, is_taken)) {
        cavity.faces.push_back(face);
        cavity.surface.push_back(cap);
      }
  }
  return cavity;
}

}  // namespace

std::vector<Cavity> find_cavities(const TetMesh& mesh) {
  std::vector<Cavity> cavities;
  for (const auto& [name, blood] : chambers)
    if (auto cavity = find_cavity(mesh, name, blood); !cavity.faces.empty()) cavities.push_back(std::move(cavity));
  return cavities;
}

std::vector<Cavity> cavities_of_part(const std::vector<Cavity>& cavities, const std::vector<std::int32_t>& new_node) {
  std::vector<Cavity> kept;
  for (Cavity cavity : cavities) {
    bool is_whole = true;
    for (auto& face : cavity.faces)
      for (auto& node : face) {
        node = new_node[static_cast<std::size_t>(node)];
        is_whole = is_whole && node >= 0;
      }
    if (is_whole) kept.push_back(std::move(cavity));
  }
  return kept;
}

}  // namespace heartgen::mesh
