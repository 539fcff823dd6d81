// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/distmesh/corners.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "generator/tetmesh/feature.hpp"

namespace heartgen::distmesh {
namespace {

constexpr double apart = 0.5;         // between two meeting points, in edges
constexpr double probe_reach = 0.12;  // all labels must be found so near to a meeting point, in edges

void add_point(Nodes& nodes, const Materials& materials, LabelBits bits, const Vec3& start, double reach_mm) {
  constexpr int newton_steps = 8;
  if (constraints(bits) != 2) return;
  const Vec3 place = tetmesh::project(materials, bits, start, newton_steps);
  const double edge = materials.edge_mm(place);
  if (!(norm(place - start) <= reach_mm)) return;
  if ((bits & ~bits_around(materials, Dimension::two, place, probe_reach * edge)) != 0) return;
  if (std::any_of(nodes.at_mm.begin(), nodes.at_mm.end(),
                  [&](const Vec3& p) { return norm(p - place) < apart * edge; }))
    return;
  nodes.at_mm.push_back(place);
  nodes.touches.push_back(bits);
}

/// Samples at the middles of equal squares that fill the box.
struct Samples {
  std::int64_t columns, rows;
  Vec3 origin, step;
  std::vector<LabelBits> bits;

  Samples(const Materials& m, double step_mm) {
    const Vec3 size = m.box_max_mm - m.box_min_mm;
    columns = std::max<std::int64_t>(2, std::llround(std::ceil(size.x / step_mm)));
    rows = std::max<std::int64_t>(2, std::llround(std::ceil(size.y / step_mm)));
    step = {size.x / static_cast<double>(columns), size.y / static_cast<double>(rows), 0};
    origin = {m.box_min_mm.x + 0.5 * step.x, m.box_min_mm.y + 0.5 * step.y, 0};
    for (std::int64_t j = 0; j < rows; ++j)
      for (std::int64_t i = 0; i < columns; ++i) bits.push_back(bit_of(m.label_at(at(i, j))));
  }
  Vec3 at(std::int64_t i, std::int64_t j) const {
    return {origin.x + static_cast<double>(i) * step.x, origin.y + static_cast<double>(j) * step.y, 0};
  }
  LabelBits operator()(std::int64_t i, std::int64_t j) const { return bits[static_cast<std::size_t>(j * columns + i)]; }
};

void add_on_sides(Nodes& nodes, const Materials& materials, const Samples& samples) {
  const double reach = 1.5 * norm(samples.step);
  const auto visit = [&](std::int64_t i, std::int64_t j, std::int64_t di, std::int64_t dj, int side) {
    const LabelBits labels = samples(i, j) | samples(i + di, j + dj);
    if (std::popcount(labels) != 2) return;
    const Vec3 middle = 0.5 * (samples.at(i, j) + samples.at(i + di, j + dj));
    add_point(nodes, materials, labels | bit_of(tetmesh::first_side + side), middle, reach);
  };
  for (std::int64_t j = 0; j + 1 < samples.rows; ++j) {
    visit(0, j, 0, 1, 0);
    visit(samples.columns - 1, j, 0, 1, 1);
  }
  for (std::int64_t i = 0; i + 1 < samples.columns; ++i) {
    visit(i, 0, 1, 0, 2);
    visit(i, samples.rows - 1, 1, 0, 3);
  }
}

}  // namespace

Nodes box_corners(const Materials& materials, Dimension dimension) {
  Nodes nodes;
  const int axes = static_cast<int>(dimension);
  for (int corner = 0; corner < 1 << axes; ++corner) {
    Vec3 p;
    LabelBits sides = 0;
    for (int axis = 0; axis < axes; ++axis) {
      const bool is_upper = (corner >> axis & 1) != 0;
      p[axis] = is_upper ? materials.box_max_mm[axis] : materials.box_min_mm[axis];
      sides |= bit_of(tetmesh::first_side + 2 * axis + (is_upper ? 1 : 0));
    }
    const int label = materials.label_at(p);
    if (label == 0) continue;
    nodes.at_mm.push_back(p);
    nodes.touches.push_back(bit_of(label) | sides);
  }
  return nodes;
}

void add_meeting_points(Nodes& nodes, const Materials& materials, double step_mm) {
  const Samples samples(materials, step_mm);
  add_on_sides(nodes, materials, samples);
  for (std::int64_t j = 0; j + 1 < samples.rows; ++j)
    for (std::int64_t i = 0; i + 1 < samples.columns; ++i) {
      const LabelBits labels = samples(i, j) | samples(i + 1, j) | samples(i, j + 1) | samples(i + 1, j + 1);
      if (std::popcount(labels) != 3) continue;
      const Vec3 middle = 0.5 * (samples.at(i, j) + samples.at(i + 1, j + 1));
      add_point(nodes, materials, labels, middle, 1.5 * norm(samples.step));
    }
}

void add_side_nodes(Nodes& nodes, const Materials& materials) {
  for (int side = 0; side < 4; ++side) {
    const int across = side / 2, along = 1 - across;
    Vec3 p = materials.box_min_mm;
    p.z = 0;
    p[across] = (side % 2 == 0 ? materials.box_min_mm : materials.box_max_mm)[across];
    while (p[along] < materials.box_max_mm[along]) {
      const double edge = materials.edge_mm(p);
      const int label = materials.label_at(p);
      const bool is_free = std::none_of(nodes.at_mm.begin(), nodes.at_mm.end(),
                                        [&](const Vec3& other) { return norm(other - p) < apart * edge; });
      if (label != 0 && is_free) {
        nodes.at_mm.push_back(p);
        nodes.touches.push_back(bit_of(label) | bit_of(tetmesh::first_side + side));
      }
      p[along] += edge;
    }
  }
}

}  // namespace heartgen::distmesh
