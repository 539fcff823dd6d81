// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The quality that repair maximises: the smallest sine of a cell's dihedral angles, where obtuse angles count
/// `obtuse_weight` times. A goal of 0.51 asks for angles in [30.7, 143.1] degrees, 0.43 for [25.5, 149.6].
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "model/vec.hpp"

namespace heartgen::tetmesh {

constexpr double obtuse_weight = 0.85;

/// At most obtuse_weight (the regular cell has it). Negative, and growing with the volume, for inverted cells. The
/// cosine of a dihedral angle is minus that of the angle between the outward normals of its two faces: no arc
/// functions, and only four square roots.
inline double cell_quality(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 pa = a - p, pb = b - p, pc = c - p;
  const Vec3 n1 = cross(pb, pc), n2 = cross(pc, pa), n3 = cross(pa, pb);
  const Vec3 n0 = -(n1 + n2 + n3);
  const double six_volumes = dot(pa, n1);
  constexpr double tiny = 1e-300;
  const double i0 = 1 / std::sqrt(dot(n0, n0) + tiny), i1 = 1 / std::sqrt(dot(n1, n1) + tiny);
  const double i2 = 1 / std::sqrt(dot(n2, n2) + tiny), i3 = 1 / std::sqrt(dot(n3, n3) + tiny);
  const double c01 = -dot(n0, n1) * i0 * i1, c02 = -dot(n0, n2) * i0 * i2, c03 = -dot(n0, n3) * i0 * i3;
  const double c12 = -dot(n1, n2) * i1 * i2, c13 = -dot(n1, n3) * i1 * i3, c23 = -dot(n2, n3) * i2 * i3;
  const auto larger = [](double x, double y) { return x > y ? x : y; };
  const auto smaller = [](double x, double y) { return x < y ? x : y; };
  const double most = larger(larger(larger(c01, c02), larger(c03, c12)), larger(larger(c13, c23), 0.0));
  const double least = smaller(smaller(smaller(c01, c02), smaller(c03, c12)), smaller(smaller(c13, c23), 0.0));
  const double acute = 1 - most * most, obtuse = obtuse_weight * obtuse_weight * (1 - least * least);
  const double good = std::sqrt(larger(smaller(acute, obtuse), 0.0));
  const double lengths = dot(pa, pa) + dot(pb, pb) + dot(pc, pc);
  const double inverted = 3 * six_volumes / (lengths * std::sqrt(lengths) + tiny) - 1e-9;
  return six_volumes > 0 ? good : inverted;
}

/// The smallest and the largest dihedral angle of a cell; 0 and 180 for flat ones. Slow beside cell_quality.
std::array<double, 2> dihedral_range_deg(const std::array<Vec3, 4>& corners);

/// Corners of a few cells, as coordinates of each corner: the qualities of all take about as long as that of one.
struct CellBatch {
  static constexpr std::size_t size = 4;
  using Corners = std::array<std::array<double, size>, 4>;
  Corners x, y, z;  // of corner, then cell

  void set(std::size_t cell, std::size_t corner, const Vec3& p) {
    x[corner][cell] = p.x;
    y[corner][cell] = p.y;
    z[corner][cell] = p.z;
  }
};

/// The same bits as cell_quality of each.
std::array<double, CellBatch::size> cell_qualities(const CellBatch& cells);

}  // namespace heartgen::tetmesh
