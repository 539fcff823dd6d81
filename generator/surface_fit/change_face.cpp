// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/change_face.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "generator/tetmesh/cavity.hpp"
#include "generator/tetmesh/collapse.hpp"

namespace heartgen::surface_fit {
namespace {

constexpr int ways = 5, shrinks = 0, pierces = 4;

using FaceEdges = std::array<std::pair<double, std::size_t>, 3>;  // length, below 0; place in the face

FaceEdges longest_first(const tetmesh::Complex& c, const Face& face) {
  FaceEdges edges;
  for (std::size_t i = 0; i < 3; ++i) edges[i] = {-norm(c.at(face[i]) - c.at(face[(i + 1) % 3])), i};
  std::sort(edges.begin(), edges.end());
  return edges;
}

// The shortest edge that can.
void shrink(tetmesh::Complex& part, const tetmesh::Materials& materials, const Face& face, const FaceEdges& edges) {
  for (auto e = edges.rbegin(); e != edges.rend(); ++e) {
    const auto a = face[e->second], b = face[(e->second + 1) % 3];
    if (tetmesh::shrink_edge(part, materials, a, b) || tetmesh::shrink_edge(part, materials, b, a)) return;
  }
}

}  // namespace

bool takes_node_away(int way) { return way % ways == shrinks; }

void change_face(tetmesh::Complex& part, const tetmesh::Materials& materials, const Face& face, int way,
                 std::uint32_t seed) {
  constexpr double shake = 0.01;  // of the lattice's width
  if (way >= ways) tetmesh::perturb(part, materials, shake * way, static_cast<std::uint32_t>(way) + 1000 * seed);
  const auto edges = longest_first(part, face);
  const int kind = way % ways;
  if (kind == shrinks) {
    shrink(part, materials, face, edges);
  } else if (kind == pierces) {
    tetmesh::split_face(part, materials, face);
  } else {
    const std::size_t i = edges[static_cast<std::size_t>(kind - 1)].second;
    tetmesh::bisect_edge(part, materials, face[i], face[(i + 1) % 3]);
  }
}

}  // namespace heartgen::surface_fit
