// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/cell_quality.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/parallel/threads.hpp"
#include "model/mathematics.hpp"

namespace heartgen::validation {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr std::array<std::array<std::size_t, 2>, 6> edges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
// Nodes opposite to each of these edges.
constexpr std::array<std::array<std::size_t, 2>, 6> opposite{{{2, 3}, {1, 3}, {1, 2}, {0, 3}, {0, 2}, {0, 1}}};

// Angle on the edge ab between the half-planes through c and d; robust for thin angles, unlike an arc cosine.
double dihedral_deg(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 axis = b - a;
  const Vec3 u = cross(axis, c - a), v = cross(axis, d - a);
  return math::atan2(norm(cross(u, v)), dot(u, v)) * degrees;
}

double area(const Vec3& a, const Vec3& b, const Vec3& c) { return norm(cross(b - a, c - a)) / 2; }

double circumradius(const std::array<Vec3, 4>& p, double volume) {
  const Vec3 a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
  return norm(dot(a, a) * cross(b, c) + dot(b, b) * cross(c, a) + dot(c, c) * cross(a, b)) / (12 * std::abs(volume));
}

/// From where `line`, that begins at a cell's centre, meets the face's plane to the face's centre, over the face's
/// reach in that direction, which counts as `min_share` of the line at least. `to_face` leads to the face's centre.
double skewness_of(const std::array<Vec3, 3>& face, const Vec3& to_face, const Vec3& line, const Vec3& normal,
                   double min_share) {
  const Vec3 off = to_face - dot(to_face, normal) / dot(line, normal) * line;
  const double length = norm(off);
  if (length == 0) return 0;
  const Vec3 face_center = (face[0] + face[1] + face[2]) / 3;
  double reach = min_share * norm(line);
  for (const auto& corner : face) reach = std::max(reach, std::abs(dot(off / length, corner - face_center)));
  return length / reach;
}

}  // namespace

CellQuality cell_quality(const std::array<Vec3, 4>& p) {
  CellQuality q;
  const double six_volumes = dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0]));
  q.volume_mm3 = six_volumes / 6;
  std::array<double, 6> length;
  std::array<double, 4> corner_product{1, 1, 1, 1};
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [i, j] = edges[e];
    q.dihedral_deg[e] = dihedral_deg(p[i], p[j], p[opposite[e][0]], p[opposite[e][1]]);
    length[e] = norm(p[j] - p[i]);
    q.edge_sum_mm += length[e];
    corner_product[i] *= length[e];
    corner_product[j] *= length[e];
  }
  const auto [least, most] = std::minmax_element(q.dihedral_deg.begin(), q.dihedral_deg.end());
  q.min_dihedral_deg = *least;
  q.max_dihedral_deg = *most;
  const auto [shortest, longest] = std::minmax_element(length.begin(), length.end());
  q.shortest_mm = *shortest;
  q.longest_mm = *longest;
  const double largest_product = *std::max_element(corner_product.begin(), corner_product.end());
  if (largest_product > 0) q.scaled_jacobian = std::sqrt(2.0) * six_volumes / largest_product;
  if (six_volumes == 0) return q;
  const double surface =
      area(p[1], p[2], p[3]) + area(p[0], p[2], p[3]) + area(p[0], p[1], p[3]) + area(p[0], p[1], p[2]);
  q.radius_ratio = 3 * (3 * std::abs(q.volume_mm3) / surface) / circumradius(p, q.volume_mm3);
  return q;
}

std::vector<CellQuality> cell_qualities(const TetMesh& mesh) {
  std::vector<CellQuality> result(mesh.cells.size());
  parallel::parallel_for(0, static_cast<std::int64_t>(result.size()), [&](std::int64_t begin, std::int64_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
      std::array<Vec3, 4> corners;
      for (std::size_t i = 0; i < 4; ++i) corners[i] = mesh.nodes_mm[static_cast<std::size_t>(mesh.cells[c][i])];
      result[c] = cell_quality(corners);
    }
  });
  return result;
}

FaceQuality face_quality(const std::array<Vec3, 3>& face, const Vec3& center, const Vec3& other_center) {
  const Vec3 normal = normalized(cross(face[1] - face[0], face[2] - face[0]));
  const Vec3 line = other_center - center;
  const Vec3 face_center = (face[0] + face[1] + face[2]) / 3;
  const double along = std::abs(dot(line, normal));
  FaceQuality q;
  q.non_orthogonality_deg = math::atan2(norm(cross(line, normal)), along) * degrees;
  if (along > 0) q.skewness = skewness_of(face, face_center - center, line, normal, 0.2);
  return q;
}

double boundary_skewness(const std::array<Vec3, 3>& face, const Vec3& center) {
  const Vec3 normal = normalized(cross(face[1] - face[0], face[2] - face[0]));
  const Vec3 to_face = (face[0] + face[1] + face[2]) / 3 - center;
  const Vec3 line = dot(normal, to_face) * normal;
  return norm(line) > 0 ? skewness_of(face, to_face, line, normal, 0.4) : 0;
}

}  // namespace heartgen::validation
