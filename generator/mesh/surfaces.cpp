#include "generator/mesh/surfaces.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "model/sort_unique.hpp"

namespace heart::mesh {
namespace {

constexpr std::int32_t rim_base = 1000;

// Faces of a positively oriented cell, normals outwards; face i lies opposite node i.
constexpr std::array<std::array<std::size_t, 3>, 4> face_corners{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

Face ascending(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

struct HalfFace {
  Face key;
  std::int32_t cell;
  std::int32_t corner;
};

HalfFace half_face(const std::vector<Cell>& cells, std::size_t cell, std::size_t corner) {
  const auto& corners = face_corners[corner];
  return {ascending({cells[cell][corners[0]], cells[cell][corners[1]], cells[cell][corners[2]]}),
          static_cast<std::int32_t>(cell), static_cast<std::int32_t>(corner)};
}

// Sorted by key, then cell: first into one bucket per smallest node, then each bucket.
std::vector<HalfFace> half_faces(const std::vector<Cell>& cells) {
  std::int32_t nodes = 0;
  for (const auto& cell : cells) nodes = std::max(nodes, 1 + *std::max_element(cell.begin(), cell.end()));
  std::vector<std::size_t> end(static_cast<std::size_t>(nodes) + 1, 0);
  const auto each = [&](auto&& visit) {
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (std::size_t f = 0; f < 4; ++f) visit(half_face(cells, c, f));
  };
  each([&](const HalfFace& half) { ++end[static_cast<std::size_t>(half.key[0]) + 1]; });
  for (std::size_t n = 1; n < end.size(); ++n) end[n] += end[n - 1];
  std::vector<HalfFace> halves(4 * cells.size());
  each([&](const HalfFace& half) { halves[end[static_cast<std::size_t>(half.key[0])]++] = half; });
  parallel::parallel_for(0, nodes, [&](std::int64_t first, std::int64_t last) {
    for (auto n = static_cast<std::size_t>(first); n < static_cast<std::size_t>(last); ++n)
      std::sort(halves.begin() + static_cast<std::ptrdiff_t>(n == 0 ? 0 : end[n - 1]),
                halves.begin() + static_cast<std::ptrdiff_t>(end[n]),
                [](const HalfFace& a, const HalfFace& b) { return std::tie(a.key, a.cell) < std::tie(b.key, b.cell); });
  });
  return halves;
}

Face outward(const Cell& cell, std::int32_t corner) {
  const auto& corners = face_corners[static_cast<std::size_t>(corner)];
  return {cell[corners[0]], cell[corners[1]], cell[corners[2]]};
}

// Keeps the nodes that cells use; returns the new id of every node (-1: dropped).
std::vector<std::int32_t> number_used_nodes(const std::vector<Vec3>& nodes_mm, TetMesh& mesh) {
  std::vector<std::int32_t> id(nodes_mm.size(), -1);
  for (const auto& cell : mesh.cells)
    for (const auto n : cell) id[static_cast<std::size_t>(n)] = 0;
  for (std::size_t n = 0; n < nodes_mm.size(); ++n) {
    if (id[n] < 0) continue;
    id[n] = static_cast<std::int32_t>(mesh.nodes_mm.size());
    mesh.nodes_mm.push_back(nodes_mm[n]);
  }
  for (auto& cell : mesh.cells)
    for (auto& n : cell) n = id[static_cast<std::size_t>(n)];
  return id;
}

}  // namespace

std::vector<CellFace> cell_faces(const std::vector<Cell>& cells) {
  const auto halves = half_faces(cells);
  std::vector<CellFace> faces;
  faces.reserve(halves.size() / 2 + 1);
  for (std::size_t h = 0; h < halves.size(); ++h) {
    const auto& half = halves[h];
    CellFace face{outward(cells[static_cast<std::size_t>(half.cell)], half.corner), half.cell, -1};
    if (h + 1 < halves.size() && halves[h + 1].key == half.key) face.other = halves[++h].cell;
    faces.push_back(face);
  }
  return faces;
}

TetMesh assemble(const std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                 const std::vector<std::int32_t>& label, const std::function<bool(std::int32_t)>& keep,
                 const std::function<std::int32_t(std::int32_t, std::int32_t)>& surface_of) {
  TetMesh mesh;
  for (const auto& face : cell_faces(cells)) {
    std::int32_t a = label[static_cast<std::size_t>(face.cell)];
    std::int32_t b = face.other < 0 ? 0 : label[static_cast<std::size_t>(face.other)];
    if (a == b || (!keep(a) && !(b != 0 && keep(b)))) continue;
    Face nodes = face.nodes;
    const bool b_is_first = b != 0 && keep(b) && (!keep(a) || b < a);
    if (b_is_first) {
      std::swap(a, b);
      std::swap(nodes[1], nodes[2]);
    }
    mesh.faces.push_back(nodes);
    mesh.surface.push_back(surface_of(a, b));
  }
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!keep(label[c])) continue;
    mesh.cells.push_back(cells[c]);
    mesh.region.push_back(label[c]);
  }
  const auto id = number_used_nodes(nodes_mm, mesh);
  for (auto& face : mesh.faces)
    for (auto& n : face) n = id[static_cast<std::size_t>(n)];
  return mesh;
}

Rim rim_of(const TetMesh& mesh, std::int32_t surface) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.surface[f] != surface) continue;
    const auto& face = mesh.faces[f];
    for (std::size_t i = 0; i < 3; ++i) edges.push_back(std::minmax(face[i], face[(i + 1) % 3]));
  }
  std::sort(edges.begin(), edges.end());
  Rim rim{surface_name(surface) + "_rim", rim_base + surface, {}};
  for (std::size_t e = 0; e < edges.size();) {
    std::size_t next = e + 1;
    while (next < edges.size() && edges[next] == edges[e]) ++next;
    if (next == e + 1) rim.nodes.insert(rim.nodes.end(), {edges[e].first, edges[e].second});
    e = next;
  }
  sort_unique(rim.nodes);
  return rim;
}

}  // namespace heart::mesh
