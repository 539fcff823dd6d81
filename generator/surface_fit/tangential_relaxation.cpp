// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/tangential_relaxation.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/slabs.hpp"
#include "generator/tetmesh/surface_faces.hpp"

namespace heartgen::surface_fit {
namespace {

constexpr double far = 0.09;       // of a face's edges, its centre from the surface: its nodes are looked at
constexpr double near = 0.06;      // nothing is gained by less
constexpr double farthest = 0.08;  // of the lattice's width: where balancing leaves nodes at most

double lack_of(double error) {
  const double beyond = std::max(0.0, error - near);
  return beyond * beyond;
}

/// A node and the faces at it.
struct Eased {
  const tetmesh::Complex* complex;
  const tetmesh::Materials* materials;
  std::int32_t node;
  std::vector<tetmesh::SurfaceFace> faces;

  /// What the faces lack with the node at `position`; `stop` where it is no less.
  double penalty(const Vec3& position, double stop) const {
    double sum = 0;
    for (const auto& face : faces) {
      const auto at = [&](std::size_t i) { return face.nodes[i] == node ? position : complex->at(face.nodes[i]); };
      const Vec3 a = at(0), b = at(1), d = at(2);
      const double edge = (norm(b - a) + norm(d - b) + norm(a - d)) / 3;
      sum += lack_of(std::abs(tetmesh::offset_at(*materials, face.labels, (a + b + d) / 3).distance) / edge);
      if (sum >= stop) return stop;
    }
    return sum;
  }
};

std::array<Vec3, 10> ways_around(const Vec3& normal) {
  const Vec3 n = normalized(normal);
  const Vec3 other = std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(n, other)), v = cross(n, u);
  const double half = std::sqrt(0.5);
  return {u, -u, v, -v, half * (u + v), -half * (u + v), half * (u - v), half * (v - u), n, -n};
}

/// The first place around a node, at one distance, where its faces lack less; false where there is none.
bool take_step(tetmesh::Complex& c, const Eased& eased, double step_mm, double max_mm, double min_quality,
               double& penalty) {
  constexpr double min_gain = 0.05;  // of the misery
  constexpr std::size_t along = 8;   // of the ways; the others go across
  const tetmesh::LabelBits labels = c.bits(eased.node) & ~tetmesh::side_bits;
  const auto here = tetmesh::offset_at(*eased.materials, labels, c.at(eased.node));
  const auto ways = ways_around(here.normal);
  const std::size_t count = step_mm < max_mm ? ways.size() : along;
  for (std::size_t w = 0; w < count; ++w) {
    Vec3 place = c.at(eased.node) + step_mm * ways[w];
    const auto there = tetmesh::offset_at(*eased.materials, labels, place);
    if (w < along)
      place += (here.distance - there.distance) * there.normal;
    else if (std::abs(there.distance) > std::max(std::abs(here.distance), max_mm))
      continue;
    const double stop = (1 - min_gain) * penalty, found = eased.penalty(place, stop);
    if (found >= stop || !tetmesh::move_node(c, eased.node, place, min_quality)) continue;
    penalty = found;
    return true;
  }
  return false;
}

void ease(tetmesh::Complex& c, const Eased& eased, double min_quality) {
  constexpr std::array steps{0.24, 0.12, 0.06};  // of the lattice's width
  const double spacing = static_cast<double>(c.spacing_mm[static_cast<std::size_t>(eased.node)]);
  double penalty = eased.penalty(c.at(eased.node), std::numeric_limits<double>::max());
  for (const double step : steps)
    if (penalty > 0) take_step(c, eased, step * spacing, farthest * spacing, min_quality, penalty);
}

// Marks the faces that are far off, of those that are marked.
void keep_far(const tetmesh::Complex& c, const tetmesh::Materials& materials,
              const std::vector<tetmesh::SurfaceFace>& faces, std::vector<std::uint8_t>& is_marked) {
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      if (is_marked[f] == 0) continue;
      const Vec3 a = c.at(faces[f].nodes[0]), b = c.at(faces[f].nodes[1]), d = c.at(faces[f].nodes[2]);
      const double edge = (norm(b - a) + norm(d - b) + norm(a - d)) / 3;
      is_marked[f] = std::abs(tetmesh::offset_at(materials, faces[f].labels, (a + b + d) / 3).distance) > far * edge;
    }
  });
}

// Those between two labels at the marked faces, with all their faces, which are marked instead. (Nodes in the box's
// sides and on curves have less room, and other surfaces to think of.)
std::vector<Eased> nodes_to_ease(const tetmesh::Complex& c, const tetmesh::Materials& materials,
                                 const std::vector<tetmesh::SurfaceFace>& faces, std::vector<std::uint8_t>& is_marked) {
  std::vector<std::int32_t> place(c.nodes_mm.size(), -1);
  std::vector<Eased> nodes;
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const auto n : faces[f].nodes) {
      auto& at = place[static_cast<std::size_t>(n)];
      if (is_marked[f] == 0 || at >= 0 || c.is_frozen(n) || std::popcount(c.bits(n)) != 2) continue;
      at = static_cast<std::int32_t>(nodes.size());
      nodes.push_back({&c, &materials, n, {}});
    }
  std::fill(is_marked.begin(), is_marked.end(), std::uint8_t{0});
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const auto n : faces[f].nodes)
      if (const auto at = place[static_cast<std::size_t>(n)]; at >= 0) {
        nodes[static_cast<std::size_t>(at)].faces.push_back(faces[f]);
        is_marked[f] = 1;
      }
  return nodes;
}

}  // namespace

void relax_tangentially(tetmesh::Complex& c, const tetmesh::Materials& materials, double min_quality,
                        tetmesh::LabelBits labels) {
  constexpr int rounds = 2;
  constexpr int max_cells = 2;         // between nodes that share one, although they have moved since
  constexpr std::size_t fewest = 100;  // nodes of a slab: fewer are not worth a thread
  if (std::adjacent_find(c.label.begin(), c.label.end(), std::not_equal_to<>()) == c.label.end()) return;
  auto faces = tetmesh::surface_faces(c);
  std::erase_if(faces, [&](const tetmesh::SurfaceFace& face) {
    return (face.labels & labels) == 0 || (face.labels & tetmesh::bit_of(0)) != 0;
  });
  std::vector<std::uint8_t> is_marked(faces.size(), 1);  // after the first round only what may have changed
  for (int round = 0; round < rounds; ++round) {
    keep_far(c, materials, faces, is_marked);
    const auto nodes = nodes_to_ease(c, materials, faces, is_marked);
    tetmesh::for_slabs(
        tetmesh::slabs_across(c, max_cells, nodes.size() / fewest), nodes.size(),
        [&](std::size_t i) { return c.at(nodes[i].node); }, [&](std::size_t i) { ease(c, nodes[i], min_quality); });
  }
}

}  // namespace heartgen::surface_fit
