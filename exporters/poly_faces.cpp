// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/poly_faces.hpp"

#include <algorithm>
#include <span>
#include <tuple>

#include "model/error.hpp"

namespace heartgen::exporters {
namespace {

/// A face as one cell sees it.
struct Side {
  std::array<std::int32_t, 2> upper;  ///< its two higher nodes, ascending
  std::int32_t cell;                  ///< or -1 - f for face f of the mesh, which brings the label
  std::int8_t opposite;               ///< corner of the cell that is not on the face
};

struct PolyFace {
  std::int32_t owner, neighbour;  ///< neighbour -1: outside
  std::int32_t surface;
  std::int8_t opposite;
};

constexpr std::size_t corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};  // seen from outside: anticlockwise

Face sorted(Face face) {
  std::sort(face.begin(), face.end());
  return face;
}

template <class Visit>
void for_each_side(const TetMesh& mesh, const Visit& visit) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    visit(sorted(mesh.faces[f]), -1 - static_cast<std::int32_t>(f), std::int8_t{0});
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (std::size_t k = 0; k < 4; ++k) {
      const Cell& n = mesh.cells[c];
      visit(sorted({n[corners[k][0]], n[corners[k][1]], n[corners[k][2]]}), static_cast<std::int32_t>(c),
            static_cast<std::int8_t>(k));
    }
}

/// All sides, those of one lowest node together; `begin[n]` is where node n's start.
struct Sides {
  std::vector<Side> sides;
  std::vector<std::size_t> begin;
};

Sides sides_by_lowest_node(const TetMesh& mesh) {
  Sides result;
  result.begin.assign(mesh.nodes_mm.size() + 2, 0);
  for_each_side(mesh, [&](const Face& face, auto, auto) { ++result.begin[static_cast<std::size_t>(face[0]) + 2]; });
  for (std::size_t n = 2; n < result.begin.size(); ++n) result.begin[n] += result.begin[n - 1];
  result.sides.resize(result.begin.back());
  for_each_side(mesh, [&](const Face& face, std::int32_t cell, std::int8_t opposite) {
    result.sides[result.begin[static_cast<std::size_t>(face[0]) + 1]++] = {{face[1], face[2]}, cell, opposite};
  });
  return result;
}

/// What the sides of one face make together: labels come first (negative), then the owner, then the neighbour.
void add_face(const TetMesh& mesh, std::span<const Side> sides, std::vector<PolyFace>& faces) {
  PolyFace face{-1, -1, 0, 0};
  for (const auto& side : sides) {
    if (side.cell < 0) {
      face.surface = mesh.surface[static_cast<std::size_t>(-1 - side.cell)];
    } else if (face.owner < 0) {
      face.owner = side.cell;
      face.opposite = side.opposite;
    } else if (face.neighbour < 0) {
      face.neighbour = side.cell;
    } else {
      throw UserError("three tetrahedra share a face", "mesh", "look at it with heartgen validate");
    }
  }
  if (face.owner >= 0) faces.push_back(face);
}

std::vector<PolyFace> all_faces(const TetMesh& mesh) {
  Sides by_node = sides_by_lowest_node(mesh);
  std::vector<PolyFace> faces;
  faces.reserve(by_node.sides.size() / 2);
  for (std::size_t n = 0; n + 1 < by_node.begin.size(); ++n) {
    const std::span sides(by_node.sides.begin() + static_cast<std::ptrdiff_t>(by_node.begin[n]),
                          by_node.sides.begin() + static_cast<std::ptrdiff_t>(by_node.begin[n + 1]));
    std::sort(sides.begin(), sides.end(),
              [](const Side& a, const Side& b) { return std::tie(a.upper, a.cell) < std::tie(b.upper, b.cell); });
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
      while (end < sides.size() && sides[end].upper == sides[begin].upper) ++end;
      add_face(mesh, sides.subspan(begin, end - begin), faces);
    }
  }
  return faces;
}

}  // namespace

PolyFaces poly_faces(const TetMesh& mesh) {
  auto faces = all_faces(mesh);
  const auto order = [](const PolyFace& f) {
    const bool is_outer = f.neighbour < 0;
    return std::tuple(is_outer, is_outer ? f.surface : 0, f.owner, is_outer ? f.opposite : f.neighbour);
  };
  std::sort(faces.begin(), faces.end(), [&](const auto& a, const auto& b) { return order(a) < order(b); });
  PolyFaces result;
  for (const auto& face : faces) {
    const Cell& n = mesh.cells[static_cast<std::size_t>(face.owner)];
    const auto& c = corners[face.opposite];
    result.nodes.push_back({n[c[0]], n[c[1]], n[c[2]]});
    result.owner.push_back(face.owner);
    if (face.neighbour >= 0) result.neighbour.push_back(face.neighbour);
    result.surface.push_back(face.surface);
  }
  return result;
}

}  // namespace heartgen::exporters
