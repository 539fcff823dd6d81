// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Linear systems of closed curves: a symmetric positive definite circulant matrix with five diagonals.
#pragma once
#include <vector>

namespace heartgen::pde {

/// The row of the matrix: `middle` on the diagonal, `near` beside it, `far` two places away, around the corner too.
struct PentadiagonalRow {
  double middle = 1, near = 0, far = 0;
};

/// Solves the n x n system, n >= 5, for several right-hand sides of length n, in place. The last two unknowns are
/// eliminated as a border, the rest is banded: linear cost. Not collective.
void solve_cyclic(const PentadiagonalRow& row, std::vector<std::vector<double>*> right_hand_sides);

}  // namespace heartgen::pde
