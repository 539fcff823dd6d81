// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/mesh_queries/mesh_laplace.hpp"

#include <algorithm>
#include <cmath>

namespace heartgen::mesh_queries {
namespace {

/// Entries of some rows to one side of the diagonal, in the numbering of the free rows.
struct Triangle {
  std::vector<std::size_t> start{0};  ///< rows + 1 values
  std::vector<std::int32_t> column;
  std::vector<double> value;

  double product(std::size_t row, const std::vector<double>& x) const {
    double sum = 0;
    for (auto e = start[row]; e < start[row + 1]; ++e) sum += value[e] * x[static_cast<std::size_t>(column[e])];
    return sum;
  }
};

/// The rows that are sought: S A S = I + lower + upper with the scale S = diagonal^-1/2.
struct FreeRows {
  std::vector<std::int32_t> row;  ///< of the whole matrix
  std::vector<double> scale;
  Triangle lower, upper;
};

FreeRows free_rows(const Stiffness& matrix, const FixedValues& fixed) {
  constexpr std::int32_t held = -1;
  FreeRows rows;
  std::vector<std::int32_t> number(fixed.size(), held);
  for (std::size_t r = 0; r < fixed.size(); ++r) {
    if (!std::isnan(fixed[r])) continue;
    for (auto e = matrix.start[r]; e < matrix.start[r + 1]; ++e)
      if (static_cast<std::size_t>(matrix.column[e]) == r && matrix.value[e] > 0) {
        number[r] = static_cast<std::int32_t>(rows.row.size());
        rows.row.push_back(static_cast<std::int32_t>(r));
        rows.scale.push_back(1 / std::sqrt(matrix.value[e]));
      }
  }
  for (std::size_t n = 0; n < rows.row.size(); ++n) {
    const auto r = static_cast<std::size_t>(rows.row[n]);
    for (auto e = matrix.start[r]; e < matrix.start[r + 1]; ++e) {
      const auto m = number[static_cast<std::size_t>(matrix.column[e])];
      if (m == held || m == static_cast<std::int32_t>(n)) continue;
      Triangle& side = m < static_cast<std::int32_t>(n) ? rows.lower : rows.upper;
      side.column.push_back(m);
      side.value.push_back(rows.scale[n] * matrix.value[e] * rows.scale[static_cast<std::size_t>(m)]);
    }
    rows.lower.start.push_back(rows.lower.column.size());
    rows.upper.start.push_back(rows.upper.column.size());
  }
  return rows;
}

/// Solves (I + lower) x = x in place.
void solve_lower(const FreeRows& rows, std::vector<double>& x) {
  for (std::size_t n = 0; n < x.size(); ++n) x[n] -= rows.lower.product(n, x);
}

/// Solves (I + upper) x = x in place.
void solve_upper(const FreeRows& rows, std::vector<double>& x) {
  for (std::size_t n = x.size(); n-- > 0;) x[n] -= rows.upper.product(n, x);
}

double row_product(const Stiffness& matrix, std::size_t r, const std::vector<double>& x) {
  double sum = 0;
  for (auto e = matrix.start[r]; e < matrix.start[r + 1]; ++e)
    sum += matrix.value[e] * x[static_cast<std::size_t>(matrix.column[e])];
  return sum;
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += a[n] * b[n];
  return sum;
}

/// Cells around each row, ascending, by their positions in matrix.cells.
struct CellsAround {
  std::vector<std::size_t> start;  ///< rows + 1 values
  std::vector<std::int32_t> cell;
};

CellsAround cells_around(const Stiffness& matrix) {
  CellsAround around;
  around.start.assign(matrix.nodes.size() + 1, 0);
  for (const auto& corners : matrix.corners)
    for (const auto row : corners) ++around.start[static_cast<std::size_t>(row) + 1];
  for (std::size_t r = 1; r < around.start.size(); ++r) around.start[r] += around.start[r - 1];
  around.cell.resize(around.start.back());
  auto next = around.start;
  for (std::size_t c = 0; c < matrix.corners.size(); ++c)
    for (const auto row : matrix.corners[c])
      around.cell[next[static_cast<std::size_t>(row)]++] = static_cast<std::int32_t>(c);
  return around;
}

struct Entry {
  std::int32_t column;
  double value;
};

/// Adds what one cell says of a row; entries of equal place become one, in the order of the cells.
void add_cell(const TetMesh& mesh, const Stiffness& matrix, std::size_t c, std::int32_t row,
              std::vector<Entry>& entries) {
  const Cell& cell = mesh.cells[static_cast<std::size_t>(matrix.cells[c])];
  const auto& corners = matrix.corners[c];
  const auto gradient = shape_gradients(mesh, cell);
  const double volume = std::abs(cell_volume_mm3(mesh, cell));
  const auto a = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), row) - corners.begin());
  for (std::size_t b = 0; b < 4; ++b) {
    const double value = volume * dot(gradient[a], gradient[b]);
    const auto known =
        std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.column == corners[b]; });
    if (known == entries.end())
      entries.push_back({corners[b], value});
    else
      known->value += value;
  }
}

void set_rows(const TetMesh& mesh, Stiffness& matrix) {
  const CellsAround around = cells_around(matrix);
  matrix.start.assign(1, 0);
  matrix.start.reserve(matrix.nodes.size() + 1);
  std::vector<Entry> entries;
  for (std::size_t r = 0; r < matrix.nodes.size(); ++r) {
    entries.clear();
    for (auto n = around.start[r]; n < around.start[r + 1]; ++n)
      add_cell(mesh, matrix, static_cast<std::size_t>(around.cell[n]), static_cast<std::int32_t>(r), entries);
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.column < b.column; });
    for (const Entry& e : entries) {
      matrix.column.push_back(e.column);
      matrix.value.push_back(e.value);
    }
    matrix.start.push_back(matrix.column.size());
  }
}

}  // namespace

std::array<Vec3, 4> shape_gradients(const TetMesh& mesh, const Cell& cell) {
  std::array<Vec3, 4> p;
  for (std::size_t n = 0; n < 4; ++n) p[n] = mesh.nodes_mm[static_cast<std::size_t>(cell[n])];
  const Vec3 a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
  const double det = dot(a, cross(b, c));
  if (std::abs(det) < 1e-30) return {};
  const Vec3 ga = cross(b, c) / det, gb = cross(c, a) / det, gc = cross(a, b) / det;
  return {-(ga + gb + gc), ga, gb, gc};
}

Stiffness make_stiffness(const TetMesh& mesh, const std::vector<std::int32_t>& cells) {
  Stiffness matrix;
  matrix.cells = cells;
  std::vector<std::int32_t> row(mesh.nodes_mm.size(), -1);
  for (const auto c : cells)
    for (const auto n : mesh.cells[static_cast<std::size_t>(c)]) row[static_cast<std::size_t>(n)] = 0;
  for (std::size_t n = 0; n < row.size(); ++n) {
    if (row[n] < 0) continue;
    row[n] = static_cast<std::int32_t>(matrix.nodes.size());
    matrix.nodes.push_back(static_cast<std::int32_t>(n));
  }
  matrix.corners.reserve(cells.size());
  for (const auto c : cells) {
    const Cell& cell = mesh.cells[static_cast<std::size_t>(c)];
    auto& corners = matrix.corners.emplace_back();
    for (std::size_t a = 0; a < 4; ++a) corners[a] = row[static_cast<std::size_t>(cell[a])];
  }
  set_rows(mesh, matrix);
  return matrix;
}

// Conjugate gradients on (I + lower)^-1 (I + lower + upper) (I + upper)^-1: with u = (I + upper)^-1 p its product with
// p is u + (I + lower)^-1 (p - u), one pass through the matrix for both the product and the preconditioner (Eisenstat,
// SIAM J. Sci. Stat. Comput. 2, 1981).
std::vector<double> solve_laplace(const Stiffness& matrix, const FixedValues& fixed) {
  constexpr int max_iterations = 2000;
  constexpr double tolerance = 1e-6;
  const FreeRows rows = free_rows(matrix, fixed);
  const std::size_t count = rows.row.size();
  std::vector<double> x = fixed;
  for (double& v : x)
    if (std::isnan(v)) v = 0;
  std::vector<double> residual(count), direction(count), step_up(count), image(count);
  for (std::size_t n = 0; n < count; ++n)
    residual[n] = -rows.scale[n] * row_product(matrix, static_cast<std::size_t>(rows.row[n]), x);
  solve_lower(rows, residual);
  const double first = product(residual, residual);
  double rho = first, before = 0;
  for (int iteration = 0; iteration < max_iterations && rho > tolerance * tolerance * first; ++iteration) {
    const double keep = iteration == 0 ? 0 : rho / before;
    for (std::size_t n = 0; n < count; ++n) direction[n] = residual[n] + keep * direction[n];
    step_up = direction;
    solve_upper(rows, step_up);
    for (std::size_t n = 0; n < count; ++n) image[n] = direction[n] - step_up[n];
    solve_lower(rows, image);
    for (std::size_t n = 0; n < count; ++n) image[n] += step_up[n];
    const double step = rho / product(direction, image);
    for (std::size_t n = 0; n < count; ++n) {
      x[static_cast<std::size_t>(rows.row[n])] += step * rows.scale[n] * step_up[n];
      residual[n] -= step * image[n];
    }
    before = rho;
    rho = product(residual, residual);
  }
  return x;
}

std::vector<Vec3> node_gradients(const TetMesh& mesh, const Stiffness& matrix, const std::vector<double>& solution) {
  std::vector<Vec3> sum(matrix.nodes.size());
  std::vector<double> volume(matrix.nodes.size());
  for (std::size_t c = 0; c < matrix.cells.size(); ++c) {
    const Cell& cell = mesh.cells[static_cast<std::size_t>(matrix.cells[c])];
    const auto gradient = shape_gradients(mesh, cell);
    const double v = std::abs(cell_volume_mm3(mesh, cell));
    Vec3 slope;
    for (std::size_t a = 0; a < 4; ++a) slope += solution[static_cast<std::size_t>(matrix.corners[c][a])] * gradient[a];
    for (const auto row : matrix.corners[c]) {
      sum[static_cast<std::size_t>(row)] += v * slope;
      volume[static_cast<std::size_t>(row)] += v;
    }
  }
  for (std::size_t n = 0; n < sum.size(); ++n)
    if (volume[n] > 0) sum[n] = sum[n] / volume[n];
  return sum;
}

}  // namespace heartgen::mesh_queries
