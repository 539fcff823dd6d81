// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/complex_measures.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

#include "generator/tetmesh/feature.hpp"

namespace heartgen::benchmarks {

using tetmesh::Complex;
using tetmesh::Materials;

Angles angles_of(const Complex& c) {
  return angles_of(c.nodes_mm, c.cells, [&](std::size_t i) { return c.cells[i][0] >= 0; });
}

double volume_of(const Complex& c, int label) {
  double sum = 0;
  for (std::size_t i = 0; i < c.cells.size(); ++i) {
    const auto& cell = c.cells[i];
    if (cell[0] >= 0 && c.label[i] == label)
      sum +=
          dot(c.at(cell[1]) - c.at(cell[0]), cross(c.at(cell[2]) - c.at(cell[0]), c.at(cell[3]) - c.at(cell[0]))) / 6;
  }
  return sum;
}

Distances distances_of(const Complex& c, const Materials& materials) {
  std::vector<double> found;
  for (std::size_t t = 0; t < c.cells.size(); ++t) {
    const auto& cell = c.cells[t];
    for (std::size_t i = 0; i < 4 && cell[0] >= 0; ++i) {
      const std::array n{cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]};
      const tetmesh::LabelBits bits = c.bits(n[0]) & c.bits(n[1]) & c.bits(n[2]);
      if (std::popcount(bits) < 2 || (bits & tetmesh::side_bits) != 0) continue;
      if (tetmesh::cells_at_face(c, n[0], n[1], n[2])[1] >= 0) continue;
      const Vec3 a = c.at(n[0]), b = c.at(n[1]), d = c.at(n[2]);
      const double edge = (norm(b - a) + norm(d - b) + norm(a - d)) / 3;
      found.push_back(tetmesh::distance_to(tetmesh::feature_at(materials, 3, (a + b + d) / 3)) / edge);
    }
  }
  return summary_of(std::move(found));
}

std::int64_t defects_of(const Complex& c) {
  std::vector<Face> faces;
  for (const auto& cell : c.cells)
    for (std::size_t i = 0; i < 4 && cell[0] >= 0; ++i) {
      faces.push_back({cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]});
      std::sort(faces.back().begin(), faces.back().end());
    }
  std::sort(faces.begin(), faces.end());
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  std::int64_t defects = 0;
  for (std::size_t f = 0; f < faces.size();) {
    std::size_t next = f + 1;
    while (next < faces.size() && faces[next] == faces[f]) ++next;
    defects += next - f > 2;
    if (next == f + 1)
      for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}})
        edges.emplace_back(faces[f][static_cast<std::size_t>(a)], faces[f][static_cast<std::size_t>(b)]);
    f = next;
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size();) {
    std::size_t next = e + 1;
    while (next < edges.size() && edges[next] == edges[e]) ++next;
    defects += next - e != 2;
    e = next;
  }
  return defects;
}

}  // namespace heartgen::benchmarks
