// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/mesh_topology.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <utility>

#include "generator/parallel/threads.hpp"

namespace heartgen::validation {
namespace {

using Edge = std::pair<std::int32_t, std::int32_t>;

Face ascending(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

std::vector<Edge> edges_of(const std::vector<Face>& faces) {
  std::vector<Edge> edges;
  edges.reserve(3 * faces.size());
  for (const auto& f : faces)
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(std::minmax(f[i], f[(i + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  return edges;
}

// Whether the triangles around a vertex hang together through edges at it. `spokes` are the other two nodes of each.
bool one_fan(const std::vector<Edge>& spokes) {
  std::vector<bool> reached(spokes.size(), false);
  std::vector<std::size_t> front{0};
  reached[0] = true;
  std::size_t count = 1;
  while (!front.empty()) {
    const Edge at = spokes[front.back()];
    front.pop_back();
    for (std::size_t i = 0; i < spokes.size(); ++i) {
      const bool shares = spokes[i].first == at.first || spokes[i].first == at.second || spokes[i].second == at.first ||
                          spokes[i].second == at.second;
      if (reached[i] || !shares) continue;
      reached[i] = true;
      ++count;
      front.push_back(i);
    }
  }
  return count == spokes.size();
}

std::int64_t count_vertices_of_several_fans(const std::vector<Face>& faces, std::int64_t& vertices) {
  std::vector<std::pair<std::int32_t, Edge>> corners;
  corners.reserve(3 * faces.size());
  for (const auto& f : faces)
    for (std::size_t i = 0; i < 3; ++i) corners.push_back({f[i], {f[(i + 1) % 3], f[(i + 2) % 3]}});
  std::sort(corners.begin(), corners.end());
  std::int64_t bad = 0;
  vertices = 0;
  std::vector<Edge> spokes;
  for (std::size_t c = 0; c < corners.size();) {
    spokes.clear();
    const auto vertex = corners[c].first;
    for (; c < corners.size() && corners[c].first == vertex; ++c) spokes.push_back(corners[c].second);
    bad += !one_fan(spokes);
    ++vertices;
  }
  return bad;
}

template <class T>
std::int64_t count_repeats(std::vector<T> values) {
  std::sort(values.begin(), values.end());
  const auto end = std::unique(values.begin(), values.end());
  return values.end() - end;
}

bool ids_are_valid(const TetMesh& mesh) {
  return std::all_of(mesh.cells.begin(), mesh.cells.end(), [&](const Cell& cell) {
    return std::all_of(cell.begin(), cell.end(),
                       [&](std::int32_t n) { return n >= 0 && static_cast<std::size_t>(n) < mesh.nodes_mm.size(); });
  });
}

/// A face as one of its cells has it, filed under its smallest node.
struct Half {
  Edge others;  ///< its other two nodes, ascending
  std::int32_t cell;
  bool operator<(const Half& half) const { return std::tie(others, cell) < std::tie(half.others, half.cell); }
};

/// All faces of all cells, those of smallest node n from start[n] to start[n + 1].
std::vector<Half> halves_by_min_node(const TetMesh& mesh, std::vector<std::size_t>& start) {
  start.assign(mesh.nodes_mm.size() + 1, 0);
  for (Cell cell : mesh.cells) {
    std::sort(cell.begin(), cell.end());
    start[static_cast<std::size_t>(cell[0]) + 1] += 3;
    start[static_cast<std::size_t>(cell[1]) + 1] += 1;
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Half> halves(4 * mesh.cells.size());
  auto next = start;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    Cell n = mesh.cells[c];
    std::sort(n.begin(), n.end());
    const auto add = [&](std::int32_t least, std::int32_t middle, std::int32_t most) {
      halves[next[static_cast<std::size_t>(least)]++] = {{middle, most}, static_cast<std::int32_t>(c)};
    };
    add(n[0], n[1], n[2]);
    add(n[0], n[1], n[3]);
    add(n[0], n[2], n[3]);
    add(n[1], n[2], n[3]);
  }
  return halves;
}

/// Sets of cells that hang together through faces, per kind; cells of different kinds never do.
template <class KindOf>
std::map<std::int32_t, std::int64_t> count_components(const TetMesh& mesh, const std::vector<MeshFace>& faces,
                                                      KindOf kind_of) {
  std::vector<std::int32_t> parent(mesh.cells.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t cell) {
    while (parent[static_cast<std::size_t>(cell)] != cell) {
      auto& up = parent[static_cast<std::size_t>(cell)];
      up = parent[static_cast<std::size_t>(up)];
      cell = up;
    }
    return cell;
  };
  for (const auto& face : faces) {
    if (face.other < 0 || kind_of(face.cell) != kind_of(face.other)) continue;
    const auto a = root(face.cell), b = root(face.other);
    parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  std::map<std::int32_t, std::int64_t> components;
  for (std::size_t c = 0; c < parent.size(); ++c)
    if (parent[c] == static_cast<std::int32_t>(c)) ++components[kind_of(static_cast<std::int32_t>(c))];
  return components;
}

}  // namespace

std::vector<MeshFace> mesh_faces(const TetMesh& mesh) {
  if (!ids_are_valid(mesh)) return {};
  std::vector<std::size_t> start;
  auto halves = halves_by_min_node(mesh, start);
  const auto nodes = static_cast<std::int64_t>(mesh.nodes_mm.size());
  std::vector<std::size_t> count(static_cast<std::size_t>(nodes) + 1, 0);
  const auto for_nodes = [&](const auto& body) {
    parallel::parallel_for(0, nodes, [&](std::int64_t begin, std::int64_t end) {
      for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n)
        body(n, halves.begin() + static_cast<std::ptrdiff_t>(start[n]),
             halves.begin() + static_cast<std::ptrdiff_t>(start[n + 1]));
    });
  };
  for_nodes([&](std::size_t n, auto first, auto last) {
    std::sort(first, last);
    for (auto h = first; h != last; ++h) count[n + 1] += h == first || h->others != (h - 1)->others;
  });
  std::partial_sum(count.begin(), count.end(), count.begin());
  std::vector<MeshFace> faces(count.back());
  for_nodes([&](std::size_t n, auto first, auto last) {
    auto next = count[n];
    for (auto h = first; h != last; ++h) {
      if (h == first || h->others != (h - 1)->others) {
        faces[next++] = {{static_cast<std::int32_t>(n), h->others.first, h->others.second}, h->cell, -1, 1};
      } else {
        faces[next - 1].other = h->cell;
        ++faces[next - 1].cells;
      }
    }
  });
  return faces;
}

FacesOfMeshes faces_of_meshes(const std::map<std::string, TetMesh>& meshes) {
  FacesOfMeshes faces;
  for (const auto& [name, mesh] : meshes) faces[name] = mesh_faces(mesh);
  return faces;
}

SurfaceTopology surface_topology(const std::vector<Face>& faces) {
  SurfaceTopology topology;
  const auto edges = edges_of(faces);
  std::int64_t edge_count = 0;
  for (std::size_t e = 0; e < edges.size(); ++edge_count) {
    std::size_t end = e;
    while (end < edges.size() && edges[end] == edges[e]) ++end;
    topology.open_edges += (end - e) % 2 == 1;
    topology.non_manifold_edges += end - e > 2;
    e = end;
  }
  std::int64_t vertices = 0;
  topology.non_manifold_vertices = count_vertices_of_several_fans(faces, vertices);
  topology.euler_characteristic = vertices - edge_count + static_cast<std::int64_t>(faces.size());
  return topology;
}

std::int64_t component_count(const TetMesh& mesh, const std::vector<MeshFace>& faces) {
  std::int64_t components = 0;
  for (const auto& [tag, count] : count_components(mesh, faces, [](std::int32_t) { return 0; })) components += count;
  return components;
}

std::map<std::int32_t, std::int64_t> component_counts(const TetMesh& mesh, const std::vector<MeshFace>& faces) {
  return count_components(mesh, faces, [&](std::int32_t cell) { return mesh.region[static_cast<std::size_t>(cell)]; });
}

std::vector<std::int32_t> node_parts(const TetMesh& mesh) {
  std::vector<std::int32_t> parent(mesh.nodes_mm.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t n) {
    while (parent[static_cast<std::size_t>(n)] != n)
      n = parent[static_cast<std::size_t>(n)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(n)])];
    return n;
  };
  for (const auto& cell : mesh.cells)
    for (const auto n : cell) {
      const auto a = root(cell[0]), b = root(n);
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  for (std::size_t n = 0; n < parent.size(); ++n) parent[n] = root(static_cast<std::int32_t>(n));
  return parent;
}

std::int64_t orphan_nodes(const TetMesh& mesh) {
  std::vector<bool> used(mesh.nodes_mm.size(), false);
  for (const auto& cell : mesh.cells)
    for (const auto n : cell) used[static_cast<std::size_t>(n)] = true;
  return std::count(used.begin(), used.end(), false);
}

std::int64_t duplicate_nodes(const TetMesh& mesh) {
  std::vector<std::array<double, 3>> places;
  places.reserve(mesh.nodes_mm.size());
  for (const auto& p : mesh.nodes_mm) places.push_back({p.x, p.y, p.z});
  return count_repeats(std::move(places));
}

std::int64_t duplicate_cells(const TetMesh& mesh) {
  auto cells = mesh.cells;
  for (auto& cell : cells) std::sort(cell.begin(), cell.end());
  return count_repeats(std::move(cells));
}

FaceLabels check_face_labels(const TetMesh& mesh, const std::vector<MeshFace>& faces) {
  FaceLabels result;
  std::vector<Face> listed;
  listed.reserve(mesh.faces.size());
  for (const auto& face : mesh.faces) listed.push_back(ascending(face));
  std::sort(listed.begin(), listed.end());
  const auto end = std::unique(listed.begin(), listed.end());
  result.repeated_faces = listed.end() - end;
  listed.erase(end, listed.end());
  for (const auto surface : mesh.surface) result.unlabelled_faces += surface == 0;

  auto next = listed.begin();
  for (const auto& face : faces) {
    while (next != listed.end() && *next < face.nodes) ++next, ++result.faces_without_cells;
    const bool is_listed = next != listed.end() && *next == face.nodes;
    if (is_listed) ++next;
    const bool outer = face.other < 0;
    const bool interface =
        !outer && mesh.region[static_cast<std::size_t>(face.cell)] != mesh.region[static_cast<std::size_t>(face.other)];
    result.missing_boundary_faces += outer && !is_listed;
    result.missing_interface_faces += interface && !is_listed;
    result.faces_inside_regions += is_listed && !outer && !interface;
  }
  result.faces_without_cells += listed.end() - next;
  return result;
}

}  // namespace heartgen::validation
