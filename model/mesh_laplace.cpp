#include "model/mesh_laplace.hpp"

#include <algorithm>
#include <cmath>

namespace heart {
namespace {

/// Rows that are sought, with the inverse of their diagonal.
struct FreeRows {
  std::vector<std::int32_t> row;
  std::vector<double> inverse_diagonal;
  std::vector<std::size_t> diagonal;  ///< entry of the matrix; columns ascend, so those before it lie to the left
};

FreeRows free_rows(const Stiffness& matrix, const FixedValues& fixed) {
  FreeRows rows;
  rows.inverse_diagonal.assign(fixed.size(), 1);
  rows.diagonal.assign(fixed.size(), 0);
  for (std::size_t r = 0; r < fixed.size(); ++r) {
    if (!std::isnan(fixed[r])) continue;
    for (auto e = matrix.start[r]; e < matrix.start[r + 1]; ++e)
      if (static_cast<std::size_t>(matrix.column[e]) == r && matrix.value[e] > 0) {
        rows.inverse_diagonal[r] = 1 / matrix.value[e];
        rows.diagonal[r] = e;
        rows.row.push_back(static_cast<std::int32_t>(r));
      }
  }
  return rows;
}

/// Sum over some entries of a row.
double part_product(const Stiffness& matrix, std::size_t first, std::size_t end, const std::vector<double>& x) {
  double sum = 0;
  for (auto e = first; e < end; ++e) sum += matrix.value[e] * x[static_cast<std::size_t>(matrix.column[e])];
  return sum;
}

double row_product(const Stiffness& matrix, std::size_t r, const std::vector<double>& x) {
  return part_product(matrix, matrix.start[r], matrix.start[r + 1], x);
}

/// z = (D + U)^-1 D (D + L)^-1 r on the free rows; z is 0 elsewhere and stays so.
void precondition(const Stiffness& matrix, const FreeRows& rows, const std::vector<double>& r, std::vector<double>& z) {
  for (const auto row : rows.row) z[static_cast<std::size_t>(row)] = 0;
  for (const auto row : rows.row) {
    const auto n = static_cast<std::size_t>(row);
    z[n] = rows.inverse_diagonal[n] * (r[n] - part_product(matrix, matrix.start[n], rows.diagonal[n], z));
  }
  for (auto it = rows.row.rbegin(); it != rows.row.rend(); ++it) {
    const auto n = static_cast<std::size_t>(*it);
    z[n] -= rows.inverse_diagonal[n] * part_product(matrix, rows.diagonal[n] + 1, matrix.start[n + 1], z);
  }
}

double product(const FreeRows& rows, const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (const auto row : rows.row) sum += a[static_cast<std::size_t>(row)] * b[static_cast<std::size_t>(row)];
  return sum;
}

struct Entry {
  std::int32_t row, column;
  double value;
};

/// Entries of equal place become one, in the order of the cells.
void compress(std::vector<Entry> entries, Stiffness& matrix) {
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.row != b.row ? a.row < b.row : a.column < b.column; });
  matrix.start.assign(matrix.nodes.size() + 1, 0);
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const bool again = e > 0 && entries[e].row == entries[e - 1].row && entries[e].column == entries[e - 1].column;
    if (again) {
      matrix.value.back() += entries[e].value;
      continue;
    }
    ++matrix.start[static_cast<std::size_t>(entries[e].row) + 1];
    matrix.column.push_back(entries[e].column);
    matrix.value.push_back(entries[e].value);
  }
  for (std::size_t r = 1; r < matrix.start.size(); ++r) matrix.start[r] += matrix.start[r - 1];
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
  std::vector<Entry> entries;
  entries.reserve(cells.size() * 16);
  matrix.corners.reserve(cells.size());
  for (const auto c : cells) {
    const Cell& cell = mesh.cells[static_cast<std::size_t>(c)];
    const auto gradient = shape_gradients(mesh, cell);
    const double volume = std::abs(cell_volume_mm3(mesh, cell));
    std::array<std::int32_t, 4> corner;
    for (std::size_t a = 0; a < 4; ++a) corner[a] = row[static_cast<std::size_t>(cell[a])];
    matrix.corners.push_back(corner);
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        entries.push_back({corner[a], corner[b], volume * dot(gradient[a], gradient[b])});
  }
  compress(std::move(entries), matrix);
  return matrix;
}

std::vector<double> solve_laplace(const Stiffness& matrix, const FixedValues& fixed) {
  constexpr int most_iterations = 2000;
  constexpr double tolerance = 1e-6;
  const FreeRows rows = free_rows(matrix, fixed);
  std::vector<double> x = fixed;
  for (double& v : x)
    if (std::isnan(v)) v = 0;
  std::vector<double> residual(x.size()), direction(x.size()), image(x.size()), scaled(x.size());
  for (const auto row : rows.row) {
    const auto n = static_cast<std::size_t>(row);
    residual[n] = -row_product(matrix, n, x);
  }
  double rho = 0, first = 0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    precondition(matrix, rows, residual, scaled);
    const double next = product(rows, residual, scaled);
    if (iteration == 0) first = next;
    if (!(next > tolerance * tolerance * first)) break;
    for (const auto row : rows.row) {
      const auto n = static_cast<std::size_t>(row);
      direction[n] = iteration == 0 ? scaled[n] : scaled[n] + next / rho * direction[n];
    }
    rho = next;
    for (const auto row : rows.row)
      image[static_cast<std::size_t>(row)] = row_product(matrix, static_cast<std::size_t>(row), direction);
    const double step = rho / product(rows, direction, image);
    for (const auto row : rows.row) {
      const auto n = static_cast<std::size_t>(row);
      x[n] += step * direction[n];
      residual[n] -= step * image[n];
    }
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

}  // namespace heart
