// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Materials with known shapes, and measures of complexes, for the tests of the lattice mesher.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "generator/stuffing/isosurface_stuffing.hpp"
#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"
#include "generator/tetmesh/repair.hpp"

namespace heartgen::testing {

using tetmesh::Complex;
using tetmesh::Equation;
using tetmesh::LabelBits;
using tetmesh::Materials;

/// Label i is where fields[i] is the largest of all.
using Fields = std::vector<std::function<double(const Vec3&)>>;

inline Vec3 gradient(const std::function<double(const Vec3&)>& field, const Vec3& p) {
  constexpr double step = 1e-5;
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 up = p, down = p;
    up[axis] += step;
    down[axis] -= step;
    g[axis] = (field(up) - field(down)) / (2 * step);
  }
  return g;
}

/// Materials in the box [-half, half]^3.
inline Materials materials_of(const Fields& fields, double half_mm, double edge_mm) {
  Materials m;
  m.box_min_mm = {-half_mm, -half_mm, -half_mm};
  m.box_max_mm = {half_mm, half_mm, half_mm};
  m.edge_mm = [edge_mm](const Vec3&) { return edge_mm; };
  m.label_at = [fields](const Vec3& p) {
    int best = 0;
    for (std::size_t i = 1; i < fields.size(); ++i)
      if (fields[i](p) > fields[static_cast<std::size_t>(best)](p)) best = static_cast<int>(i);
    return best;
  };
  m.equations_at = [fields](LabelBits labels, const Vec3& p, std::span<Equation> equations) {
    std::size_t count = 0, first = fields.size();
    for (std::size_t i = 0; i < fields.size() && count < equations.size(); ++i) {
      if ((labels >> i & 1U) == 0) continue;
      if (first == fields.size())
        first = i;
      else
        equations[count++] = {fields[i](p) - fields[first](p), gradient(fields[i], p) - gradient(fields[first], p)};
    }
    return static_cast<int>(count);
  };
  return m;
}

/// Material 1 above z = 0.3, material 2 below it, in a ball of 5 mm.
inline Materials ball_of_two_halves(const Vec3& center = {}) {
  return materials_of(
      {[](const Vec3&) { return 0.0; }, [center](const Vec3& p) { return std::min(5 - norm(p - center), p.z - 0.3); },
       [center](const Vec3& p) { return std::min(5 - norm(p - center), 0.3 - p.z); }},
      8, 0.9);
}

inline std::array<double, 2> dihedral_range(const Complex& c) {
  std::array<double, 2> range{180, 0};
  for (const auto& cell : c.cells) {
    if (cell[0] < 0) continue;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const auto [k, l] = tetmesh::others(cell, cell[i], cell[j]);
        const Vec3 along = c.at(cell[j]) - c.at(cell[i]);
        const Vec3 n1 = cross(along, c.at(k) - c.at(cell[i])), n2 = cross(along, c.at(l) - c.at(cell[i]));
        const double cosine = std::clamp(dot(n1, n2) / (norm(n1) * norm(n2)), -1.0, 1.0);
        const double angle = std::acos(cosine) * 180 / std::numbers::pi;
        range = {std::min(range[0], angle), std::max(range[1], angle)};
      }
  }
  return range;
}

inline double volume_of(const Complex& c, const Cell& cell) {
  return dot(c.at(cell[1]) - c.at(cell[0]), cross(c.at(cell[2]) - c.at(cell[0]), c.at(cell[3]) - c.at(cell[0]))) / 6;
}

inline double volume_of(const Complex& c, int label) {
  double sum = 0;
  for (std::size_t i = 0; i < c.cells.size(); ++i)
    if (c.cells[i][0] >= 0 && c.label[i] == label) sum += volume_of(c, c.cells[i]);
  return sum;
}

inline double min_volume(const Complex& c) {
  double least = 1e300;
  for (const auto& cell : c.cells)
    if (cell[0] >= 0) least = std::min(least, volume_of(c, cell));
  return least;
}

/// Faces with how many cells each has.
inline std::map<Face, int> face_counts(const std::vector<Cell>& cells) {
  std::map<Face, int> counts;
  for (const auto& cell : cells)
    for (std::size_t i = 0; i < 4 && cell[0] >= 0; ++i) {
      Face face{cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]};
      std::sort(face.begin(), face.end());
      ++counts[face];
    }
  return counts;
}

/// Edges of the outer surface that do not have exactly two of its faces; faces with more than two cells count too.
inline int defects(const Complex& c) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  int bad = 0;
  for (const auto& [face, count] : face_counts(c.cells)) {
    if (count > 2) ++bad;
    if (count != 1) continue;
    ++edges[{face[0], face[1]}];
    ++edges[{face[0], face[2]}];
    ++edges[{face[1], face[2]}];
  }
  for (const auto& [edge, count] : edges) bad += count != 2;
  return bad;
}

struct Meshed {
  Complex complex;
  std::int64_t below_goal = 0;
};

/// Stuffed, without settling of labels, and repaired.
inline Meshed mesh_of(const Materials& materials, const tetmesh::RepairSettings& settings = {}) {
  Meshed result{stuffing::stuff_isosurfaces(materials, {}), 0};
  tetmesh::derive_touches(result.complex);
  tetmesh::compress(result.complex);
  result.below_goal = tetmesh::repair(result.complex, materials, settings);
  tetmesh::compress(result.complex);
  return result;
}

}  // namespace heartgen::testing
