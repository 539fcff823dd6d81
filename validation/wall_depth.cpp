#include "validation/wall_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace heart::validation {
namespace {

constexpr double unknown = -1;

/// Row-compressed symmetric matrix over the nodes of the wall.
struct Stiffness {
  std::vector<std::size_t> start;
  std::vector<std::int32_t> column;
  std::vector<double> value;
};

std::array<Vec3, 4> shape_gradients(const TetMesh& mesh, const Cell& cell) {
  std::array<Vec3, 4> p;
  for (std::size_t n = 0; n < 4; ++n) p[n] = mesh.nodes_mm[static_cast<std::size_t>(cell[n])];
  const Vec3 a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
  const double det = dot(a, cross(b, c));
  if (std::abs(det) < 1e-30) return {};
  const Vec3 ga = cross(b, c) / det, gb = cross(c, a) / det, gc = cross(a, b) / det;
  return {-(ga + gb + gc), ga, gb, gc};
}

/// 0 or 1 on the nodes of the two surfaces, `unknown` elsewhere; the endocardium wins at their common rim.
std::vector<double> fixed_depths(const TetMesh& mesh, Region ventricle) {
  const bool left = ventricle == Region::lv_myocardium;
  const auto inner = *surface_from_name(left ? "lv_endocardium" : "rv_endocardium");
  const auto base = *surface_from_name("papillary_base");
  const auto outer = *surface_from_name("epicardium");
  const auto septal = left ? *surface_from_name("rv_endocardium") : outer;
  std::vector<double> fixed(mesh.nodes_mm.size(), unknown);
  const auto set = [&](double depth, auto chosen) {
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
      if (chosen(mesh.surface[f]))
        for (const auto n : mesh.faces[f]) fixed[static_cast<std::size_t>(n)] = depth;
  };
  set(1, [&](std::int32_t s) { return s == outer || s == septal; });
  set(0, [&](std::int32_t s) { return s == inner || s == base; });
  return fixed;
}

Stiffness stiffness_of(const TetMesh& mesh, const std::vector<std::int32_t>& cells) {
  struct Entry {
    std::int32_t row, column;
    double value;
  };
  std::vector<Entry> entries;
  entries.reserve(cells.size() * 16);
  for (const auto c : cells) {
    const Cell& cell = mesh.cells[static_cast<std::size_t>(c)];
    const auto gradient = shape_gradients(mesh, cell);
    const double volume = std::abs(cell_volume_mm3(mesh, cell));
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b) entries.push_back({cell[a], cell[b], volume * dot(gradient[a], gradient[b])});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.row != b.row ? a.row < b.row : a.column < b.column; });
  Stiffness matrix;
  matrix.start.assign(mesh.nodes_mm.size() + 1, 0);
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
  for (std::size_t n = 1; n < matrix.start.size(); ++n) matrix.start[n] += matrix.start[n - 1];
  return matrix;
}

/// matrix * x on the free nodes; 0 on the others.
void apply(const Stiffness& matrix, const std::vector<std::uint8_t>& free, const std::vector<double>& x,
           std::vector<double>& result) {
  for (std::size_t n = 0; n < x.size(); ++n) {
    result[n] = 0;
    if (!free[n]) continue;
    for (auto e = matrix.start[n]; e < matrix.start[n + 1]; ++e)
      result[n] += matrix.value[e] * x[static_cast<std::size_t>(matrix.column[e])];
  }
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += a[n] * b[n];
  return sum;
}

std::vector<double> inverse_diagonal(const Stiffness& matrix) {
  std::vector<double> inverse(matrix.start.size() - 1, 1);
  for (std::size_t n = 0; n < inverse.size(); ++n)
    for (auto e = matrix.start[n]; e < matrix.start[n + 1]; ++e)
      if (static_cast<std::size_t>(matrix.column[e]) == n && matrix.value[e] > 0) inverse[n] = 1 / matrix.value[e];
  return inverse;
}

/// Conjugate gradients on the free nodes; x holds the fixed values and the start.
void solve(const Stiffness& matrix, const std::vector<std::uint8_t>& free, std::vector<double>& x) {
  constexpr int most_iterations = 600;
  constexpr double tolerance = 1e-6;
  const auto inverse = inverse_diagonal(matrix);
  std::vector<double> residual(x.size()), direction(x.size()), image(x.size()), scaled(x.size());
  apply(matrix, free, x, residual);
  for (double& r : residual) r = -r;
  double rho = 0, first = 0;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    for (std::size_t n = 0; n < x.size(); ++n) scaled[n] = inverse[n] * residual[n];
    const double next = product(residual, scaled);
    if (iteration == 0) first = next;
    if (next <= tolerance * tolerance * first || next == 0) break;
    for (std::size_t n = 0; n < x.size(); ++n)
      direction[n] = iteration == 0 ? scaled[n] : scaled[n] + next / rho * direction[n];
    rho = next;
    apply(matrix, free, direction, image);
    const double step = rho / product(direction, image);
    for (std::size_t n = 0; n < x.size(); ++n) {
      x[n] += step * direction[n];
      residual[n] -= step * image[n];
    }
  }
}

}  // namespace

WallDepth wall_depth(const TetMesh& mesh, Region ventricle) {
  WallDepth wall;
  std::vector<std::uint8_t> used(mesh.nodes_mm.size()), free(mesh.nodes_mm.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (mesh.region[c] == tag(ventricle)) {
      wall.cells.push_back(static_cast<std::int32_t>(c));
      for (const auto n : mesh.cells[c]) used[static_cast<std::size_t>(n)] = 1;
    }
  auto depth = fixed_depths(mesh, ventricle);
  bool inner = false, outer = false;
  for (std::size_t n = 0; n < depth.size(); ++n) {
    inner |= used[n] && depth[n] == 0;
    outer |= used[n] && depth[n] == 1;
    free[n] = used[n] && depth[n] == unknown;
    if (depth[n] == unknown) depth[n] = used[n] ? 0.5 : 0;
  }
  if (!inner || !outer) return {};
  solve(stiffness_of(mesh, wall.cells), free, depth);
  for (const auto c : wall.cells) {
    const Cell& cell = mesh.cells[static_cast<std::size_t>(c)];
    const auto gradient = shape_gradients(mesh, cell);
    double mean = 0;
    Vec3 slope;
    for (std::size_t n = 0; n < 4; ++n) {
      mean += 0.25 * depth[static_cast<std::size_t>(cell[n])];
      slope += depth[static_cast<std::size_t>(cell[n])] * gradient[n];
    }
    wall.depth.push_back(mean);
    wall.normal.push_back(normalized(slope));
  }
  return wall;
}

}  // namespace heart::validation
