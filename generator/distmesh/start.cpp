// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/start.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "generator/stuffing/octree.hpp"
#include "model/mathematics.hpp"

namespace heartgen::distmesh {
namespace {

/// A number in [0, 1) that depends on four integers only.
double uniform(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t salt) {
  std::uint64_t state = 0x9E3779B97F4A7C15ULL;
  for (const auto v : {i, j, k, salt}) {  // splitmix64
    state += static_cast<std::uint64_t>(v) + 0x9E3779B97F4A7C15ULL;
    state = (state ^ (state >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    state = (state ^ (state >> 27U)) * 0x94D049BB133111EBULL;
    state ^= state >> 31U;
  }
  return static_cast<double>(state >> 11U) * 0x1.0p-53;
}

/// A lattice whose mean edge is `width`: equilateral triangles, or body-centred cubes.
struct Lattice {
  Vec3 origin, step;  // of its rows
  std::array<std::int64_t, 3> count{1, 1, 1};
  Dimension dimension;

  Lattice(const Materials& m, Dimension d, double width) : dimension(d) {
    const double cube = width / stuffing::mean_edge_per_cell;
    step = d == Dimension::two ? Vec3{width, width * std::sqrt(3.0) / 2, 1} : Vec3{cube, cube, cube / 2};
    for (int axis = 0; axis < static_cast<int>(d); ++axis) {
      const double length = m.box_max_mm[axis] - m.box_min_mm[axis];
      count[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::ceil(length / step[axis])) + 3;
      origin[axis] = m.box_min_mm[axis] - step[axis];
    }
  }
  Vec3 at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const double row =
        dimension == Dimension::two ? 0.5 * static_cast<double>(j % 2) : 0.5 * static_cast<double>(k % 2);
    const double column = dimension == Dimension::two ? 0 : row;
    return {origin.x + (static_cast<double>(i) + row) * step.x, origin.y + (static_cast<double>(j) + column) * step.y,
            dimension == Dimension::two ? 0 : origin.z + static_cast<double>(k) * step.z};
  }
};

bool is_wanted(const Materials& materials, Dimension dimension, const Vec3& p, double edge, LabelBits bits) {
  constexpr double reach = 0.5;
  return !is_outside(bits) || !is_outside(bits_around(materials, dimension, p, reach * edge));
}

void add_class(Nodes& nodes, const Materials& materials, Dimension dimension, double width, double next_width,
               std::int64_t salt) {
  const Lattice lattice(materials, dimension, width);
  for (std::int64_t k = 0; k < lattice.count[2]; ++k)
    for (std::int64_t j = 0; j < lattice.count[1]; ++j)
      for (std::int64_t i = 0; i < lattice.count[0]; ++i) {
        const Vec3 p = lattice.at(i, j, k);
        const double edge = materials.edge_mm(p);
        if (edge < width || edge >= next_width) continue;
        if (uniform(i, j, k, salt) >= math::pow(width / edge, static_cast<int>(dimension))) continue;
        const LabelBits bits = bits_at(materials, p);
        if (!is_wanted(materials, dimension, p, edge, bits)) continue;
        nodes.at_mm.push_back(p);
        nodes.touches.push_back(bits);
      }
}

// Nodes on top of the first ones would have to be removed at once.
void drop_near_first(Nodes& nodes, const Materials& materials, std::size_t first) {
  constexpr double apart = 0.5;
  std::size_t kept = first;
  for (std::size_t n = first; n < nodes.size(); ++n) {
    const Vec3 p = nodes.at_mm[n];
    const double reach = apart * materials.edge_mm(p);
    const bool is_near = std::any_of(nodes.at_mm.begin(), nodes.at_mm.begin() + static_cast<std::ptrdiff_t>(first),
                                     [&](const Vec3& f) { return norm(f - p) < reach; });
    if (is_near) continue;
    nodes.at_mm[kept] = p;
    nodes.touches[kept++] = nodes.touches[n];
  }
  nodes.at_mm.resize(kept);
  nodes.touches.resize(kept);
}

}  // namespace

void add_start_nodes(Nodes& nodes, const Materials& materials, Dimension dimension, double min_edge_mm) {
  const std::size_t first = nodes.size();
  const Vec3 size = materials.box_max_mm - materials.box_min_mm;
  const double longest = dimension == Dimension::two ? std::max(size.x, size.y) : std::max({size.x, size.y, size.z});
  const auto width_mm = [&](std::int64_t number) {
    return min_edge_mm * math::pow(2.0, 0.5 * static_cast<double>(number));
  };
  for (std::int64_t number = 0; width_mm(number) < longest; ++number)
    add_class(nodes, materials, dimension, (number == 0 ? 0.999999 : 1) * width_mm(number), width_mm(number + 1),
              number);
  drop_near_first(nodes, materials, first);
}

}  // namespace heartgen::distmesh
