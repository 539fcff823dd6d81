// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/tetmesh/quality.hpp"

#include <numbers>

#include "generator/parallel/simd.hpp"
#include "model/mathematics.hpp"

namespace heartgen::tetmesh {
namespace {

HEARTGEN_INLINE void rate(const CellBatch& c, double* quality) {
  for (std::size_t i = 0; i < CellBatch::size; ++i)
    quality[i] = cell_quality({c.x[0][i], c.y[0][i], c.z[0][i]}, {c.x[1][i], c.y[1][i], c.z[1][i]},
                              {c.x[2][i], c.y[2][i], c.z[2][i]}, {c.x[3][i], c.y[3][i], c.z[3][i]});
}

// Outwards or all inwards, of the face opposite to each corner.
std::array<Vec3, 4> unit_normals(const std::array<Vec3, 4>& p) {
  const Vec3 a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
  const Vec3 n1 = cross(b, c), n2 = cross(c, a), n3 = cross(a, b);
  return {normalized(-(n1 + n2 + n3)), normalized(n1), normalized(n2), normalized(n3)};
}

}  // namespace

std::array<double, 2> dihedral_range_deg(const std::array<Vec3, 4>& corners) {
  const auto normals = unit_normals(corners);
  std::array<double, 2> range{180, 0};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double angle = math::acos(std::clamp(-dot(normals[i], normals[j]), -1.0, 1.0)) * 180 / std::numbers::pi;
      range = {std::min(range[0], angle), std::max(range[1], angle)};
    }
  return range;
}

std::array<double, CellBatch::size> cell_qualities(const CellBatch& cells) {
  std::array<double, CellBatch::size> quality;
  parallel::vectorised<rate>(cells, quality.data());
  return quality;
}

}  // namespace heartgen::tetmesh
