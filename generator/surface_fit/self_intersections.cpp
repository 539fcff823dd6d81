// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/self_intersections.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>
#include <vector>

#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/surface_fit/marked_cubes.hpp"
#include "generator/tetmesh/box.hpp"
#include "generator/tetmesh/flips.hpp"
#include "model/mathematics.hpp"
#include "model/sort_unique.hpp"

namespace heartgen::surface_fit {
namespace {

constexpr std::array<std::array<std::size_t, 3>, 4> opposite{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

void add_outer_faces(const tetmesh::Complex& c, const Cell& cell, std::vector<Face>& faces) {
  for (const auto& corners : opposite) {
    const Face face{cell[corners[0]], cell[corners[1]], cell[corners[2]]};
    const tetmesh::LabelBits shared = c.bits(face[0]) & c.bits(face[1]) & c.bits(face[2]);
    if ((shared & tetmesh::bit_of(0)) != 0 && (shared & tetmesh::side_bits) == 0 &&
        tetmesh::cells_at_face(c, face[0], face[1], face[2])[1] < 0)
      faces.push_back(face);
  }
}

using Triangle = std::array<Vec3, 3>;

double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return dot(b - a, cross(c - a, d - a)); }

// Whether the line through two places on either side of a triangle's plane goes through the triangle.
bool line_goes_through(const Vec3& from, const Vec3& to, const Triangle& t) {
  const double a = volume(from, to, t[0], t[1]), b = volume(from, to, t[1], t[2]), c = volume(from, to, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// Some faces and where their nodes are.
struct Faces {
  const std::vector<Vec3>* nodes_mm;
  const std::vector<Face>* faces;
  const Vec3& at(std::int32_t n) const { return (*nodes_mm)[static_cast<std::size_t>(n)]; }
  const Face& face(std::int32_t f) const { return (*faces)[static_cast<std::size_t>(f)]; }
};

bool shares_edge(const Face& a, const Face& b) {
  int shared = 0;
  for (const auto n : a) shared += n == b[0] || n == b[1] || n == b[2] ? 1 : 0;
  return shared > 1;
}

/// Of a face's nodes, as another face sees them: on which side of its plane, and which of them are its own.
struct Sides {
  std::array<double, 3> side{};
  std::array<bool, 3> is_shared{};
  bool is_one() const {
    bool has_low = false, has_high = false;
    for (std::size_t i = 0; i < 3; ++i) {
      has_low = has_low || (!is_shared[i] && side[i] <= 0);
      has_high = has_high || (!is_shared[i] && side[i] >= 0);
    }
    return !has_low || !has_high;
  }
};

Sides sides_of(const Faces& all, const Face& a, const Face& b, const Triangle& t) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  Sides sides;
  for (std::size_t i = 0; i < 3; ++i) {
    sides.side[i] = dot(normal, all.at(a[i]) - t[0]);
    sides.is_shared[i] = a[i] == b[0] || a[i] == b[1] || a[i] == b[2];
  }
  return sides;
}

// Whether an edge that has no node of a face goes through that face.
bool pierces(const Sides& sides, const Triangle& edges, const Triangle& face) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    const bool one_side = (sides.side[i] > 0 && sides.side[next] > 0) || (sides.side[i] < 0 && sides.side[next] < 0);
    if (!one_side && !sides.is_shared[i] && !sides.is_shared[next] && line_goes_through(edges[i], edges[next], face))
      return true;
  }
  return false;
}

// Whether an edge of one goes through the other. Most faces lie on one side of the other's plane: no edge of either
// can go through the other then.
bool meet(const Faces& all, const Face& a, const Face& b) {
  const Triangle p{all.at(a[0]), all.at(a[1]), all.at(a[2])}, q{all.at(b[0]), all.at(b[1]), all.at(b[2])};
  const auto seen_from_b = sides_of(all, a, b, q);
  if (seen_from_b.is_one()) return false;
  const auto seen_from_a = sides_of(all, b, a, p);
  return !seen_from_a.is_one() && (pierces(seen_from_b, p, q) || pierces(seen_from_a, q, p));
}

struct FaceBox : tetmesh::Box {
  std::array<std::int32_t, 3> first_cube{}, last_cube{};  // of a grid, that the box meets
};

FaceBox box_of(const Faces& all, std::int32_t f) {
  const auto& face = all.face(f);
  return {tetmesh::box_around(std::array{all.at(face[0]), all.at(face[1]), all.at(face[2])}), {}, {}};
}

/// Faces by the cubes of a grid that their boxes meet.
struct CubeGrid {
  Vec3 origin;
  double width = 1;
  std::array<std::int32_t, 3> size{1, 1, 1};
  std::vector<std::int32_t> first, faces;  // of cube c: faces[first[c]] to faces[first[c + 1] - 1], ascending

  std::array<std::int32_t, 3> extract_cavity(const Vec3& p) const {
    std::array<std::int32_t, 3> place{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      place[a] = std::clamp(static_cast<std::int32_t>((p[axis] - origin[axis]) / width), 0, size[a] - 1);
    }
    return place;
  }
  std::size_t cube_at(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(i);
  }
  template <class Body>
  void for_cubes(const FaceBox& box, Body&& body) const {
    const auto &low = box.first_cube, &high = box.last_cube;
    for (auto k = low[2]; k <= high[2]; ++k)
      for (auto j = low[1]; j <= high[1]; ++j)
        for (auto i = low[0]; i <= high[0]; ++i) body(cube_at(i, j, k));
  }
};

// Without faces.
CubeGrid empty_grid(const std::vector<FaceBox>& boxes) {
  constexpr double widths = 1.5;  // of a cube, in mean widths of a box
  constexpr double max_cubes_per_face = 8;
  tetmesh::Box all = boxes[0];
  double sum = 0;
  for (const auto& box : boxes) {
    all.add(box.low);
    all.add(box.high);
    sum += std::max({box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z});
  }
  const Vec3 extent = all.high - all.low;
  const double room = extent.x * extent.y * extent.z / (max_cubes_per_face * static_cast<double>(boxes.size()));
  CubeGrid grid;
  grid.origin = all.low;
  grid.width = std::max({widths * sum / static_cast<double>(boxes.size()), math::cbrt(room), 1e-9});
  for (int axis = 0; axis < 3; ++axis)
    grid.size[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(extent[axis] / grid.width) + 1;
  return grid;
}

// Tells the boxes their cubes.
CubeGrid grid_over(std::vector<FaceBox>& boxes) {
  auto grid = empty_grid(boxes);
  parallel::parallel_for(0, static_cast<std::int64_t>(boxes.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      boxes[f].first_cube = grid.extract_cavity(boxes[f].low);
      boxes[f].last_cube = grid.extract_cavity(boxes[f].high);
    }
  });
  const auto& size = grid.size;
  grid.first.assign(grid.cube_at(0, 0, size[2]) + 1, 0);
  for (const auto& box : boxes) grid.for_cubes(box, [&](std::size_t cube) { ++grid.first[cube + 1]; });
  for (std::size_t cube = 1; cube < grid.first.size(); ++cube) grid.first[cube] += grid.first[cube - 1];
  grid.faces.resize(static_cast<std::size_t>(grid.first.back()));
  auto next = grid.first;
  for (std::size_t f = 0; f < boxes.size(); ++f)
    grid.for_cubes(boxes[f], [&](std::size_t cube) {
      grid.faces[static_cast<std::size_t>(next[cube]++)] = static_cast<std::int32_t>(f);
    });
  return grid;
}

// Pairs of faces of one cube whose boxes meet, where this is the first cube that both boxes meet.
void add_meeting(const Faces& all, const std::vector<FaceBox>& boxes, const CubeGrid& grid, std::size_t cube,
                 std::vector<FacePair>& pairs) {
  const auto is_first = [&](const FaceBox& a, const FaceBox& b) {
    return grid.cube_at(std::max(a.first_cube[0], b.first_cube[0]), std::max(a.first_cube[1], b.first_cube[1]),
                        std::max(a.first_cube[2], b.first_cube[2])) == cube;
  };
  for (auto i = grid.first[cube]; i < grid.first[cube + 1]; ++i)
    for (auto j = i + 1; j < grid.first[cube + 1]; ++j) {
      const auto f = grid.faces[static_cast<std::size_t>(i)], g = grid.faces[static_cast<std::size_t>(j)];
      const auto &a = boxes[static_cast<std::size_t>(f)], &b = boxes[static_cast<std::size_t>(g)];
      if (!a.meets(b) || !is_first(a, b) || shares_edge(all.face(f), all.face(g))) continue;
      if (meet(all, all.face(f), all.face(g))) pairs.emplace_back(f, g);
    }
}

// Each once, ascending.
std::vector<std::int32_t> nodes_of(const std::vector<Face>& faces, const std::vector<FacePair>& pairs) {
  std::vector<std::int32_t> nodes;
  for (const auto& [one, other] : pairs)
    for (const auto f : {one, other})
      for (const auto n : faces[static_cast<std::size_t>(f)]) nodes.push_back(n);
  sort_unique(nodes);
  return nodes;
}

std::vector<Face> faces_at(const std::vector<Face>& faces, const std::vector<std::int32_t>& nodes) {
  const auto is_at_node = [&](const Face& face) {
    return std::ranges::any_of(face, [&](auto n) { return std::ranges::binary_search(nodes, n); });
  };
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<Face>& found) {
    std::copy_if(faces.begin() + begin, faces.begin() + end, std::back_inserter(found), is_at_node);
  };
  return parallel::gather<Face>(0, std::ssize(faces), find);
}

// The mean direction out of the mesh at each node, of all outer faces there.
std::vector<Vec3> ways_out(const tetmesh::Complex& c, const std::vector<Face>& faces,
                           const std::vector<std::int32_t>& nodes) {
  std::vector<Vec3> ways(nodes.size());
  for (const auto& face : faces) {
    const Vec3 normal = cross(c.at(face[1]) - c.at(face[0]), c.at(face[2]) - c.at(face[0]));
    for (const auto n : face) {
      const auto found = std::ranges::lower_bound(nodes, n);
      if (found != nodes.end() && *found == n) ways[static_cast<std::size_t>(found - nodes.begin())] += normal;
    }
  }
  return ways;
}

// Those that some faces may meet.
std::vector<Face> faces_near(const tetmesh::Complex& c, const std::vector<Face>& faces, const std::vector<Face>& some) {
  std::vector<tetmesh::Box> boxes;
  boxes.reserve(some.size());
  for (const auto& face : some) boxes.push_back(box_of(c, face));
  const MarkedCubes cubes(boxes);
  return parallel::gather<Face>(0, static_cast<std::int64_t>(faces.size()),
                                [&](std::int64_t begin, std::int64_t end, std::vector<Face>& near) {
                                  std::copy_if(faces.begin() + begin, faces.begin() + end, std::back_inserter(near),
                                               [&](const Face& face) { return cubes.may_meet(box_of(c, face)); });
                                });
}

void draw_back(tetmesh::Complex& c, std::int32_t node, const Vec3& way_out, double min_quality) {
  constexpr double max_shift = 0.06;  // of the lattice's width
  constexpr int tries = 4;
  if (c.is_frozen(node) || (c.bits(node) & tetmesh::side_bits) != 0 || dot(way_out, way_out) == 0) return;
  const double length = max_shift * static_cast<double>(c.spacing_mm[static_cast<std::size_t>(node)]);
  tetmesh::shift_node(c, node, -length * normalized(way_out), tries, min_quality);
}

// Gives the cell behind one of each two faces that meet to the outside, where that changes no topology. Whether any
// went.
bool peel(tetmesh::Complex& c) {
  const auto faces = outer_faces(c);
  bool is_any = false;
  for (const auto& pair : self_intersecting_faces(c.nodes_mm, faces))
    for (const auto f : {pair.first, pair.second}) {
      const auto& face = faces[static_cast<std::size_t>(f)];
      const auto cell = tetmesh::cells_at_face(c, face[0], face[1], face[2])[0];
      if (cell < 0) break;  // gone for another pair
      if (!tetmesh::relabel(c, cell, 0)) continue;
      is_any = true;
      break;
    }
  return is_any;
}

}  // namespace

std::vector<Face> outer_faces(const tetmesh::Complex& c) {
  return parallel::gather<Face>(0, static_cast<std::int64_t>(c.cells.size()),
                                [&](std::int64_t begin, std::int64_t end, std::vector<Face>& faces) {
                                  for (auto t = begin; t < end; ++t)
                                    if (c.is_alive(static_cast<std::int32_t>(t)))
                                      add_outer_faces(c, c.cell(static_cast<std::int32_t>(t)), faces);
                                });
}

std::vector<FacePair> self_intersecting_faces(const std::vector<Vec3>& nodes_mm, const std::vector<Face>& faces) {
  if (faces.empty()) return {};
  const Faces all{&nodes_mm, &faces};
  std::vector<FaceBox> boxes(faces.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = begin; f < end; ++f) boxes[static_cast<std::size_t>(f)] = box_of(all, static_cast<std::int32_t>(f));
  });
  const auto grid = grid_over(boxes);
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<FacePair>& pairs) {
    for (auto cube = begin; cube < end; ++cube) add_meeting(all, boxes, grid, static_cast<std::size_t>(cube), pairs);
  };
  return parallel::gather_sorted<FacePair>(0, static_cast<std::int64_t>(grid.first.size()) - 1, find);
}

std::int64_t resolve_self_intersections_gently(tetmesh::Complex& complex, double min_quality) {
  constexpr int max_rounds = 8;
  const auto all = outer_faces(complex);
  auto faces = all;
  auto pairs = self_intersecting_faces(complex.nodes_mm, faces);
  for (int round = 0; round < max_rounds && !pairs.empty(); ++round) {
    const auto nodes = nodes_of(faces, pairs);
    const auto moved = faces_at(all, nodes);
    const auto ways = ways_out(complex, moved, nodes);
    for (std::size_t i = 0; i < nodes.size(); ++i) draw_back(complex, nodes[i], ways[i], min_quality);
    faces = faces_near(complex, all, moved);  // no others can have begun or ceased to meet
    pairs = self_intersecting_faces(complex.nodes_mm, faces);
  }
  return static_cast<std::int64_t>(pairs.size());
}

std::int64_t resolve_self_intersections(tetmesh::Complex& complex, double min_quality) {
  constexpr double late_quality = 0.4885;  // angles in [29, 145] degrees
  constexpr int max_peelings = 4;
  auto left = resolve_self_intersections_gently(complex, min_quality);
  const double quality = std::min(min_quality, late_quality);
  if (left != 0) left = resolve_self_intersections_gently(complex, quality);
  for (int i = 0; i < max_peelings && left != 0 && peel(complex); ++i)
    left = resolve_self_intersections_gently(complex, quality);
  return left;
}

}  // namespace heartgen::surface_fit
