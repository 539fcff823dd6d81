// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pde/cyclic_pentadiagonal.hpp"

#include <cstddef>

namespace heartgen::pde {
namespace {

using Vector = std::vector<double>;

/// L D Lᵀ of the banded matrix without the corners.
struct Banded {
  Vector d, l1, l2;  ///< pivots, first and second subdiagonal of L (l1[i] belongs to row i + 1)
};

Banded factorised(const PentadiagonalRow& row, std::size_t m) {
  Banded f{Vector(m), Vector(m, 0.0), Vector(m, 0.0)};
  for (std::size_t i = 0; i < m; ++i) {
    const double before = i >= 1 ? f.l1[i - 1] * f.l1[i - 1] * f.d[i - 1] : 0;
    const double two_before = i >= 2 ? f.l2[i - 2] * f.l2[i - 2] * f.d[i - 2] : 0;
    f.d[i] = row.middle - before - two_before;
    const double shared = i >= 1 ? f.l2[i - 1] * f.d[i - 1] * f.l1[i - 1] : 0;
    f.l1[i] = (row.near - shared) / f.d[i];
    f.l2[i] = row.far / f.d[i];
  }
  return f;
}

/// Solves for the first d.size() entries of x.
void solve(const Banded& f, Vector& x) {
  const std::size_t m = f.d.size();
  for (std::size_t i = 0; i < m; ++i) {
    if (i >= 1) x[i] -= f.l1[i - 1] * x[i - 1];
    if (i >= 2) x[i] -= f.l2[i - 2] * x[i - 2];
  }
  for (std::size_t i = 0; i < m; ++i) x[i] /= f.d[i];
  for (std::size_t i = m; i-- > 0;) {
    if (i + 1 < m) x[i] -= f.l1[i] * x[i + 1];
    if (i + 2 < m) x[i] -= f.l2[i] * x[i + 2];
  }
}

}  // namespace

void solve_cyclic(const PentadiagonalRow& row, std::vector<Vector*> right_hand_sides) {
  const std::size_t n = right_hand_sides.front()->size(), m = n - 2;
  const Banded banded = factorised(row, m);
  // The border: columns n - 2 and n - 1 of the first m rows. Entries add up where a small n makes them meet.
  Vector u(m, 0.0), v(m, 0.0);
  u[m - 2] += row.far;
  u[m - 1] += row.near;
  u[0] += row.far;
  v[m - 1] += row.far;
  v[0] += row.near;
  v[1] += row.far;
  Vector tu = u, tv = v;
  solve(banded, tu);
  solve(banded, tv);
  const auto dot = [m](const Vector& a, const Vector& b) {
    double sum = 0;
    for (std::size_t i = 0; i < m; ++i) sum += a[i] * b[i];
    return sum;
  };
  const double a = row.middle - dot(u, tu), b = row.near - dot(u, tv), c = row.middle - dot(v, tv);
  const double determinant = a * c - b * b;
  for (Vector* rhs : right_hand_sides) {
    Vector& x = *rhs;
    solve(banded, x);
    const double p = x[n - 2] - dot(u, x), q = x[n - 1] - dot(v, x);
    x[n - 2] = (c * p - b * q) / determinant;
    x[n - 1] = (a * q - b * p) / determinant;
    for (std::size_t i = 0; i < m; ++i) x[i] -= tu[i] * x[n - 2] + tv[i] * x[n - 1];
  }
}

}  // namespace heartgen::pde
