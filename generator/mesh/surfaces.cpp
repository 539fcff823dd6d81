// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/surfaces.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>

#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::mesh {
namespace {

constexpr std::int32_t rim_base = 1000;

// Faces of a positively oriented cell, normals outwards; face i lies opposite node i.
constexpr std::array<std::array<std::size_t, 3>, 4> face_corners{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

Face ascending(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

/// Half of a face, of those whose smallest node is the same.
struct HalfFace {
  std::uint64_t others;  ///< the other two nodes, the smaller one in the upper half
  std::int64_t place;    ///< 4 * cell + corner
  bool operator<(const HalfFace& other) const { return std::tie(others, place) < std::tie(other.others, other.place); }
};

Face outward(const Cell& cell, std::int32_t corner) {
  const auto& corners = face_corners[static_cast<std::size_t>(corner)];
  return {cell[corners[0]], cell[corners[1]], cell[corners[2]]};
}

std::int32_t count_nodes(const std::vector<Cell>& cells) {
  std::int32_t nodes = 0;
  for (const auto& cell : cells) nodes = std::max(nodes, 1 + *std::max_element(cell.begin(), cell.end()));
  return nodes;
}

/// Half faces in one bucket per smallest node, of the nodes from `first` on.
struct Buckets {
  std::int64_t first;
  std::vector<std::size_t> end;  // of bucket n - first: from end[n - first - 1], or 0, to end[n - first]
  std::vector<HalfFace> halves;
};

/// Which faces are looked at: those all of whose nodes are marked. No marks: all.
struct Wanted {
  const std::vector<std::uint8_t>* is_marked;
  bool operator()(std::int32_t node) const {
    return is_marked->empty() || (*is_marked)[static_cast<std::size_t>(node)] != 0;
  }
  bool operator()(const Face& face) const { return (*this)(face[0]) && (*this)(face[1]) && (*this)(face[2]); }
  bool has_face_of(const Cell& cell) const {
    return std::count_if(cell.begin(), cell.end(), [&](std::int32_t n) { return (*this)(n); }) > 2;
  }
};

Buckets buckets_of(const std::vector<Cell>& cells, const Wanted& wanted, std::int64_t first, std::int64_t last) {
  const auto each = [&](auto&& visit) {
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (std::int32_t corner = 0; corner < 4 && wanted.has_face_of(cells[c]); ++corner) {
        const Face key = ascending(outward(cells[c], corner));
        if (key[0] >= first && key[0] < last && wanted(key))
          visit(static_cast<std::size_t>(key[0] - first), key, static_cast<std::int64_t>(4 * c) + corner);
      }
  };
  Buckets buckets{first, std::vector<std::size_t>(static_cast<std::size_t>(last - first) + 1, 0), {}};
  each([&](std::size_t bucket, const Face&, std::int64_t) { ++buckets.end[bucket + 1]; });
  for (std::size_t n = 1; n < buckets.end.size(); ++n) buckets.end[n] += buckets.end[n - 1];
  buckets.halves.resize(buckets.end.back());
  each([&](std::size_t bucket, const Face& key, std::int64_t place) {
    const auto others = static_cast<std::uint64_t>(key[1]) << 32U | static_cast<std::uint64_t>(key[2]);
    buckets.halves[buckets.end[bucket]++] = {others, place};
  });
  return buckets;
}

// Of the faces with smallest nodes from `first` on, ascending.
template <class Keep>
void add_faces(const std::vector<Cell>& cells, const Wanted& wanted, std::int64_t first, std::int64_t last,
               const Keep& keep, std::vector<CellFace>& faces) {
  auto [_, end, halves] = buckets_of(cells, wanted, first, last);
  std::size_t begin = 0;
  for (std::size_t bucket = 0; bucket + 1 < end.size(); begin = end[bucket++]) {
    std::sort(halves.begin() + static_cast<std::ptrdiff_t>(begin),
              halves.begin() + static_cast<std::ptrdiff_t>(end[bucket]));
    for (std::size_t h = begin; h < end[bucket]; ++h) {
      const auto cell = static_cast<std::int32_t>(halves[h].place / 4);
      CellFace face{outward(cells[static_cast<std::size_t>(cell)], static_cast<std::int32_t>(halves[h].place % 4)),
                    cell, -1};
      if (h + 1 < end[bucket] && halves[h + 1].others == halves[h].others)
        face.other = static_cast<std::int32_t>(halves[++h].place / 4);
      if (keep(face)) faces.push_back(face);
    }
  }
}

// Each thread reads all cells, and sorts the faces of its own nodes.
template <class Keep>
std::vector<CellFace> faces_where(const std::vector<Cell>& cells, const Wanted& wanted, const Keep& keep) {
  std::vector<std::vector<CellFace>> of_thread(static_cast<std::size_t>(parallel::thread_count()));
  parallel::parallel_for(0, count_nodes(cells), [&](std::int64_t first, std::int64_t last, int thread) {
    std::vector<CellFace> own;
    add_faces(cells, wanted, first, last, keep, own);
    of_thread[static_cast<std::size_t>(thread)] = std::move(own);
  });
  return parallel::joined(std::span(std::as_const(of_thread)));
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
  const std::vector<std::uint8_t> all;
  return faces_where(cells, {&all}, [](const CellFace&) { return true; });
}

TetMesh assemble(const LabelledCells& labelled, const std::function<bool(std::int32_t)>& keep,
                 const std::function<std::int32_t(std::int32_t, std::int32_t)>& surface_of) {
  const auto& cells = labelled.cells;
  const auto& label = labelled.label;
  TetMesh mesh;
  const auto labels_at = [&](const CellFace& face) {
    return std::pair{label[static_cast<std::size_t>(face.cell)],
                     face.other < 0 ? 0 : label[static_cast<std::size_t>(face.other)]};
  };
  const auto is_kept = [&](const CellFace& face) {
    const auto [a, b] = labels_at(face);
    return a != b && (keep(a) || (b != 0 && keep(b)));
  };
  for (const auto& face : faces_where(cells, {&labelled.is_on_surface}, is_kept)) {
    auto [a, b] = labels_at(face);
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
  const auto id = number_used_nodes(labelled.nodes_mm, mesh);
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

}  // namespace heartgen::mesh
