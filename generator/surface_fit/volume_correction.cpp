// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/surface_fit/volume_correction.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include "generator/parallel/gather.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/feature.hpp"
#include "generator/tetmesh/slabs.hpp"
#include "generator/tetmesh/surface_faces.hpp"

namespace heartgen::surface_fit {
namespace {

// The mean of a quadratic function over a triangle, from its values at the centre and at the corners.
constexpr double share_of_center = 0.75, share_of_corner = 1.0 / 12;
constexpr double max_shift = 0.08;  // of the lattice's width: farther from the surface no node goes
constexpr double evenness = 0.5;    // of what a node stands out from those around it, taken back in one round
constexpr double min_slant = 0.5;   // of the surface against the sides

// Nodes between two labels, also where their surface ends in a side of the box.
bool is_on_surface(tetmesh::LabelBits touches) { return std::popcount(touches & ~tetmesh::side_bits) == 2; }
bool is_on_curve(tetmesh::LabelBits touches) { return std::popcount(touches & ~tetmesh::side_bits) > 2; }

/// What one round measures; all per node but `center`.
struct Measures {
  std::vector<tetmesh::Offset> node;  // of nodes on surfaces
  std::vector<double> center;         // signed distance of each face's centre
  std::vector<Vec3> to_curve;         // step of nodes on curves
};

// Renews what depends on nodes that are marked: after the first rounds few still move.
void measure(const tetmesh::Complex& c, const tetmesh::Materials& materials,
             const std::vector<tetmesh::SurfaceFace>& faces, const std::vector<std::uint8_t>& is_marked,
             Measures& found) {
  constexpr int newton_steps = 3;
  found.node.resize(c.nodes_mm.size());
  found.to_curve.resize(c.nodes_mm.size());
  found.center.resize(faces.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(c.nodes_mm.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (is_marked[n] == 0) continue;
      const tetmesh::LabelBits bits = c.touches[n];
      if (is_on_surface(bits)) found.node[n] = tetmesh::offset_at(materials, bits & ~tetmesh::side_bits, c.nodes_mm[n]);
      if (is_on_curve(bits))
        found.to_curve[n] = tetmesh::project(materials, bits, c.nodes_mm[n], newton_steps) - c.nodes_mm[n];
    }
  });
  parallel::parallel_for(0, static_cast<std::int64_t>(faces.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      const auto& n = faces[f].nodes;
      if (std::none_of(n.begin(), n.end(), [&](std::int32_t i) { return is_marked[static_cast<std::size_t>(i)] != 0; }))
        continue;
      found.center[f] =
          tetmesh::offset_at(materials, faces[f].labels, (c.at(n[0]) + c.at(n[1]) + c.at(n[2])) / 3).distance;
    }
  });
}

// Along the normal, or in the side of the box along it.
Vec3 along_normal(tetmesh::LabelBits touches, Vec3 normal, double distance) {
  for (int side = 0; side < 6; ++side)
    if ((touches & tetmesh::bit_of(tetmesh::first_side + side)) != 0) normal[side / 2] = 0;
  const double slant = dot(normal, normal);
  return slant < min_slant ? Vec3{} : distance / slant * normal;
}

std::vector<Vec3> shifts_of(const tetmesh::Complex& c, const std::vector<tetmesh::SurfaceFace>& faces,
                            const Measures& found) {
  std::vector<double> error(c.nodes_mm.size(), 0), around(c.nodes_mm.size(), 0);
  std::vector<int> count(c.nodes_mm.size(), 0);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    double corners = 0;
    for (const auto n : faces[f].nodes) corners += found.node[static_cast<std::size_t>(n)].distance;
    for (const auto n : faces[f].nodes) {
      const auto at = static_cast<std::size_t>(n);
      if ((c.touches[at] & ~tetmesh::side_bits) != faces[f].labels) continue;
      error[at] += share_of_center * found.center[f] + share_of_corner * corners;
      around[at] += 0.5 * (corners - found.node[at].distance);
      ++count[at];
    }
  }
  std::vector<Vec3> shift(found.to_curve);
  parallel::parallel_for(0, static_cast<std::int64_t>(shift.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const double limit = max_shift * static_cast<double>(c.spacing_mm[n]);
      if (const double length = norm(shift[n]); length > limit) shift[n] *= limit / length;
      if (count[n] == 0) continue;
      const double own = found.node[n].distance;
      const double wanted = -error[n] / count[n] - evenness * (own - around[n] / count[n]);
      shift[n] = along_normal(c.touches[n], found.node[n].normal, std::clamp(own + wanted, -limit, limit) - own);
    }
  });
  return shift;
}

// Where the centre of a face is far off, its nodes go to where the worst of the faces around them are equally far off
// on both sides.
std::vector<Vec3> shifts_at_worst(const tetmesh::Complex& c, const std::vector<tetmesh::SurfaceFace>& faces,
                                  const Measures& found) {
  constexpr double far = 0.08;  // of the lattice's width
  constexpr double step = 0.5;  // of the way of a face's centre, which all three nodes of the face move
  std::vector<std::array<double, 2>> range(c.nodes_mm.size(), {0, 0});
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const auto n : faces[f].nodes) {
      const auto at = static_cast<std::size_t>(n);
      if ((c.touches[at] & ~tetmesh::side_bits) != faces[f].labels) continue;
      range[at] = {std::min(range[at][0], found.center[f]), std::max(range[at][1], found.center[f])};
    }
  std::vector<Vec3> shift(c.nodes_mm.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(shift.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const auto [low, high] = range[n];
      const double spacing = static_cast<double>(c.spacing_mm[n]), limit = max_shift * spacing;
      if (std::max(-low, high) < far * spacing) continue;
      const double own = found.node[n].distance;
      const double wanted = std::clamp(own - step * (low + high), -limit, limit) - own;
      shift[n] = along_normal(c.touches[n], found.node[n].normal, wanted);
    }
  });
  return shift;
}

/// By how much the faces between two labels are off in the mean: signed distance times area, and area.
struct MeanOffset {
  double volume_mm3 = 0, area_mm2 = 0;
  double mm() const { return area_mm2 > 0 ? volume_mm3 / area_mm2 : 0; }
};
using MeanOffsets = std::map<tetmesh::LabelBits, MeanOffset>;

MeanOffsets mean_offsets(const tetmesh::Complex& c, const std::vector<tetmesh::SurfaceFace>& faces,
                         const Measures& found) {
  MeanOffsets sums;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& n = faces[f].nodes;
    double offset = share_of_center * found.center[f];
    for (const auto corner : n) offset += share_of_corner * found.node[static_cast<std::size_t>(corner)].distance;
    const double area = 0.5 * norm(cross(c.at(n[1]) - c.at(n[0]), c.at(n[2]) - c.at(n[0])));
    auto& sum = sums[faces[f].labels];
    sum.volume_mm3 += area * offset;
    sum.area_mm2 += area;
  }
  return sums;
}

std::vector<Vec3> shifts_to_even_out(const tetmesh::Complex& c, const MeanOffsets& offsets, const Measures& found) {
  constexpr double min_way = 5e-4;  // of the lattice's width
  std::vector<Vec3> shift(c.nodes_mm.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(shift.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (!is_on_surface(c.touches[n])) continue;
      const auto offset = offsets.find(c.touches[n] & ~tetmesh::side_bits);
      const double spacing = static_cast<double>(c.spacing_mm[n]), limit = max_shift * spacing;
      if (offset == offsets.end() || std::abs(offset->second.mm()) < min_way * spacing) continue;
      const double own = found.node[n].distance;
      // A node beyond its limit stays where it is.
      const double wanted = std::clamp(own - offset->second.mm(), std::min(own, -limit), std::max(own, limit));
      shift[n] = along_normal(c.touches[n], found.node[n].normal, wanted - own);
    }
  });
  return shift;
}

/// The nodes that move in one round, and which of all have moved in the last one.
struct Rounds {
  tetmesh::Slabs slabs;
  std::vector<std::int32_t> to_move;
  std::vector<std::uint8_t> is_marked;
};

void shift_nodes(tetmesh::Complex& c, const std::vector<Vec3>& shift, double min_way, double min_quality,
                 Rounds& rounds) {
  constexpr int tries = 3;
  auto& to_move = rounds.to_move;
  auto& is_marked = rounds.is_marked;
  const auto is_to_move = [&](std::int32_t node) {
    const auto n = static_cast<std::size_t>(node);
    return norm(shift[n]) > min_way * static_cast<double>(c.spacing_mm[n]) && !c.is_frozen(node);
  };
  const auto find = [&](std::int64_t begin, std::int64_t end, std::vector<std::int32_t>& found) {
    for (auto n = static_cast<std::int32_t>(begin); n < end; ++n)
      if (is_to_move(n)) found.push_back(n);
  };
  to_move = parallel::gather<std::int32_t>(0, static_cast<std::int64_t>(shift.size()), find);
  std::fill(is_marked.begin(), is_marked.end(), std::uint8_t{0});
  tetmesh::for_slabs(
      rounds.slabs, to_move.size(), [&](std::size_t i) { return c.at(to_move[i]); },
      [&](std::size_t i) {
        const auto n = static_cast<std::size_t>(to_move[i]);
        is_marked[n] = tetmesh::shift_node(c, to_move[i], shift[n], tries, min_quality);
      });
}

Rounds rounds_over(const tetmesh::Complex& c, const std::vector<tetmesh::SurfaceFace>& faces) {
  constexpr std::size_t fewest = 2000;  // faces of a slab: fewer are not worth a thread
  constexpr int max_cells = 2;          // between nodes that share one, although they have moved since
  return {
      tetmesh::slabs_across(c, max_cells, faces.size() / fewest), {}, std::vector<std::uint8_t>(c.nodes_mm.size(), 1)};
}

}  // namespace

void correct_surface_volumes(tetmesh::Complex& c, const tetmesh::Materials& materials, double min_quality) {
  constexpr int rounds = 4, rounds_at_worst = 2;
  constexpr double min_way = 1e-3;  // of the lattice's width
  const auto faces = tetmesh::surface_faces(c);
  auto moving = rounds_over(c, faces);
  Measures found;
  for (int round = 0; round < rounds + rounds_at_worst; ++round) {
    measure(c, materials, faces, moving.is_marked, found);
    const auto shift = round < rounds ? shifts_of(c, faces, found) : shifts_at_worst(c, faces, found);
    shift_nodes(c, shift, min_way, min_quality, moving);
  }
}

void equalize_volumes(tetmesh::Complex& c, const tetmesh::Materials& materials, double min_quality) {
  constexpr int rounds = 2;  // in the first one, nodes at their limit do not take their share
  const auto faces = tetmesh::surface_faces(c);
  auto moving = rounds_over(c, faces);
  Measures found;
  for (int round = 0; round < rounds; ++round) {
    measure(c, materials, faces, moving.is_marked, found);
    shift_nodes(c, shifts_to_even_out(c, mean_offsets(c, faces, found), found), 0, min_quality, moving);
  }
}

}  // namespace heartgen::surface_fit
