// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/cgal_delaunay.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace heartgen::adapters {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex2 = CGAL::Triangulation_vertex_base_with_info_2<std::int32_t, Kernel>;
using Delaunay2 = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertex2>>;
using Vertex3 = CGAL::Triangulation_vertex_base_with_info_3<std::int32_t, Kernel>;
using Cell3 = CGAL::Delaunay_triangulation_cell_base_3<Kernel>;
using Delaunay3 = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<Vertex3, Cell3>>;

template <class Point, class Make>
std::vector<std::pair<Point, std::int32_t>> numbered(std::span<const Vec3> points, const Make& make) {
  std::vector<std::pair<Point, std::int32_t>> result;
  result.reserve(points.size());
  for (const auto& p : points) result.emplace_back(make(p), static_cast<std::int32_t>(result.size()));
  return result;
}

}  // namespace

std::vector<Face> delaunay_triangles(std::span<const Vec3> points) {
  const auto input = numbered<Kernel::Point_2>(points, [](const Vec3& p) { return Kernel::Point_2(p.x, p.y); });
  const Delaunay2 triangulation(input.begin(), input.end());
  std::vector<Face> triangles;
  triangles.reserve(triangulation.number_of_faces());
  for (const auto face : triangulation.finite_face_handles()) {
    Face ids{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
    std::rotate(ids.begin(), std::min_element(ids.begin(), ids.end()), ids.end());
    triangles.push_back(ids);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::vector<Cell> delaunay_cells(std::span<const Vec3> points) {
  const auto input = numbered<Kernel::Point_3>(points, [](const Vec3& p) { return Kernel::Point_3(p.x, p.y, p.z); });
  const Delaunay3 triangulation(input.begin(), input.end());
  std::vector<Cell> cells;
  cells.reserve(triangulation.number_of_finite_cells());
  for (const auto cell : triangulation.finite_cell_handles()) {
    Cell ids;
    for (std::size_t i = 0; i < 4; ++i) ids[i] = cell->vertex(static_cast<int>(i))->info();
    bool is_even = true;  // of the permutation that sorts the nodes
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (ids[j] < ids[i]) is_even = !is_even;
    std::sort(ids.begin(), ids.end());
    if (!is_even) std::swap(ids[2], ids[3]);
    cells.push_back(ids);
  }
  std::sort(cells.begin(), cells.end());
  return cells;
}

}  // namespace heartgen::adapters
