// SPDX-License-Identifier: GPL-3.0-or-later
// Area of an implicit surface on voxels: the estimators of length.hpp one dimension up.
#include <algorithm>
#include <array>
#include <cmath>

#include "benchmarks/study/length.hpp"
#include "model/error.hpp"
#include "model/vec.hpp"

namespace heartgen::study {
namespace {

double cube_side_mm(const Volume<double>& phi) {
  const Vec3& s = phi.grid.spacing_mm;
  if (s.x != s.y || s.y != s.z)
    throw UserError("the voxels are not cubes", "area of a level set", "resample the image to one spacing");
  return s.x;
}

/// Differences to the six neighbours (0 across the border): forward and backward along x, y, z.
struct Differences {
  std::array<double, 3> ahead{}, behind{};
};

Differences differences(const Volume<double>& phi, std::int64_t i, std::int64_t j, std::int64_t k) {
  Differences d;
  const double here = phi(i, j, k);
  const Index3 at{i, j, k};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Index3 next = at, previous = at;
    next[axis] = std::min(at[axis] + 1, phi.grid.size[axis] - 1);
    previous[axis] = std::max<std::int64_t>(at[axis] - 1, 0);
    d.ahead[axis] = phi(next[0], next[1], next[2]) - here;
    d.behind[axis] = here - phi(previous[0], previous[1], previous[2]);
  }
  return d;
}

/// Sum of value(phi, differences) over all voxels, in their order.
template <class Value>
double sum_voxels(const Volume<double>& phi, Value&& value) {
  double sum = 0;
  for (std::int64_t k = 0; k < phi.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < phi.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < phi.grid.size[0]; ++i) sum += value(phi(i, j, k), differences(phi, i, j, k));
  return sum;
}

bool crosses(double a, double b) { return (a >= 0) != (b >= 0); }

double norm(const std::array<double, 3>& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

struct Corner {
  Vec3 at;
  double value;
};

Vec3 zero_point(const Corner& a, const Corner& b) { return a.at + (b.at - a.at) * (a.value / (a.value - b.value)); }

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) { return norm(cross(b - a, c - a)) / 2; }

/// The zero surface in a tetrahedron: nothing, a triangle, or a plane quadrilateral.
double area_in_tetrahedron(std::array<Corner, 4> c) {
  std::stable_sort(c.begin(), c.end(),
                   [](const Corner& a, const Corner& b) { return (a.value >= 0) > (b.value >= 0); });
  const auto positive = std::count_if(c.begin(), c.end(), [](const Corner& a) { return a.value >= 0; });
  if (positive == 1) return triangle_area(zero_point(c[0], c[1]), zero_point(c[0], c[2]), zero_point(c[0], c[3]));
  if (positive == 3) return triangle_area(zero_point(c[3], c[0]), zero_point(c[3], c[1]), zero_point(c[3], c[2]));
  if (positive != 2) return 0;
  const Vec3 p = zero_point(c[0], c[2]), q = zero_point(c[0], c[3]), r = zero_point(c[1], c[3]),
             s = zero_point(c[1], c[2]);
  return triangle_area(p, q, r) + triangle_area(p, r, s);
}

/// The six tetrahedra of a cube around its diagonal from corner 0 to corner 7 (bit 0: x, bit 1: y, bit 2: z).
constexpr std::array<std::array<std::size_t, 4>, 6> tetrahedra_of_cube = {
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

double area_in_cube(const Volume<double>& phi, std::int64_t i, std::int64_t j, std::int64_t k) {
  const Vec3& s = phi.grid.spacing_mm;
  std::array<Corner, 8> corner{};
  for (std::size_t c = 0; c < 8; ++c) {
    const std::int64_t x = c & 1, y = (c >> 1) & 1, z = c >> 2;
    corner[c] = {{static_cast<double>(x) * s.x, static_cast<double>(y) * s.y, static_cast<double>(z) * s.z},
                 phi(i + x, j + y, k + z)};
  }
  double area = 0;
  for (const auto& t : tetrahedra_of_cube)
    area += area_in_tetrahedron({corner[t[0]], corner[t[1]], corner[t[2]], corner[t[3]]});
  return area;
}

}  // namespace

double gaussian_area(const Volume<double>& phi, double beta_mm) {
  const double h = cube_side_mm(phi);
  return h * h * sum_voxels(phi, [&](double here, const Differences& d) {
           return gaussian_delta(here, beta_mm) * norm(d.ahead);
         });
}

double heaviside_area(const Volume<double>& phi) {
  const double h = cube_side_mm(phi);
  return h * h * sum_voxels(phi, [](double here, const Differences& d) {
           int changes = 0;
           for (const double ahead : d.ahead) changes += crosses(here, here + ahead);
           return std::sqrt(changes);
         });
}

double smereka_area(const Volume<double>& phi, double epsilon) {
  const double h = cube_side_mm(phi);
  return h * h * sum_voxels(phi, [&](double here, const Differences& d) {
           std::array<double, 3> central{};
           for (std::size_t axis = 0; axis < 3; ++axis) central[axis] = (d.ahead[axis] + d.behind[axis]) / 2;
           const double gradient = std::sqrt(norm(central) * norm(central) + epsilon * h * h);
           double weight = 0;
           for (std::size_t axis = 0; axis < 3; ++axis)
             for (const double there : {here + d.ahead[axis], here - d.behind[axis]})
               if (crosses(here, there))
                 weight += std::abs(there * central[axis]) / (std::abs(there - here) * gradient);
           return weight;
         });
}

double tetrahedra_area(const Volume<double>& phi) {
  double area = 0;
  for (std::int64_t k = 0; k + 1 < phi.grid.size[2]; ++k)
    for (std::int64_t j = 0; j + 1 < phi.grid.size[1]; ++j)
      for (std::int64_t i = 0; i + 1 < phi.grid.size[0]; ++i) area += area_in_cube(phi, i, j, k);
  return area;
}

}  // namespace heartgen::study
