// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/adapters/cgal_mesher.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/exude_mesh_3.h>
#include <CGAL/perturb_mesh_3.h>
#include <CGAL/refine_mesh_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace heartgen::adapters {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

// Mesh_3 bounds circumradii. With these factors the mean edge of the cells comes out as the wanted edge.
constexpr double cell_radius_per_edge = 0.85;
constexpr double facet_radius_per_edge = 0.72;

Vec3 to_vec(const Point& p) { return {p.x(), p.y(), p.z()}; }

struct ScaledSize {
  using FT = Kernel::FT;
  const ImplicitDomain* domain;
  double factor;
  FT operator()(const Point& p, int, const Domain::Index&) const { return factor * domain->edge_mm(to_vec(p)); }
};

Domain make_domain(const ImplicitDomain& domain, const DelaunaySettings& settings, CGAL::Random& random) {
  namespace parameters = CGAL::parameters;
  const CGAL::Bbox_3 box(domain.box_min_mm.x, domain.box_min_mm.y, domain.box_min_mm.z, domain.box_max_mm.x,
                         domain.box_max_mm.y, domain.box_max_mm.z);
  const double half_diagonal = norm(domain.box_max_mm - domain.box_min_mm) / 2;
  return Domain([&domain](const Point& p) { return domain.label_at(to_vec(p)); }, box,
                parameters::relative_error_bound = settings.precision_mm / half_diagonal, parameters::p_rng = &random);
}

// Vertices with a weight keep refinement out of their balls, so that edges between neighbours stay in the mesh.
// Dimension 0 marks corners: nothing moves them. Dimension 2: on a surface.
void insert_first_points(Complex& complex, const Domain& domain, const ImplicitDomain& implicit) {
  auto& triangulation = complex.triangulation();
  const auto weighted = triangulation.geom_traits().construct_weighted_point_3_object();
  const auto insert = [&](const Vec3& p, double radius, int dimension) {
    auto point = weighted(Point(p.x, p.y, p.z));
    if (radius > 0) point = Triangulation::Weighted_point(point.point(), radius * radius);
    const auto vertex = triangulation.insert(point);
    if (vertex == Triangulation::Vertex_handle()) return;
    complex.set_dimension(vertex, dimension);
    complex.set_index(vertex, domain.index_from_surface_patch_index({0, 1}));
  };
  for (const auto& ball : implicit.curve_balls) insert(ball.center_mm, ball.radius_mm, 0);
  const auto protected_by_ball = [&](const Vec3& p) {
    return std::any_of(implicit.curve_balls.begin(), implicit.curve_balls.end(),
                       [&](const CurveBall& ball) { return norm(p - ball.center_mm) < 1.2 * ball.radius_mm; });
  };
  for (const auto& p : implicit.surface_points_mm)
    if (!protected_by_ball(p)) insert(p, 0, 2);
}

void refine(Complex& complex, const Domain& domain, const ImplicitDomain& implicit, const DelaunaySettings& settings) {
  namespace parameters = CGAL::parameters;
  const Criteria criteria(parameters::facet_angle = settings.facet_angle_deg,
                          parameters::facet_size = ScaledSize{&implicit, facet_radius_per_edge},
                          parameters::facet_distance = ScaledSize{&implicit, settings.surface_distance},
                          parameters::cell_radius_edge_ratio = settings.radius_edge_ratio,
                          parameters::cell_size = ScaledSize{&implicit, cell_radius_per_edge});
  // No optimisers by default: perturbation and exudation need time limits (exudation can go on for ever without one),
  // so that their result would depend on the clock.
  CGAL::refine_mesh_3(complex, domain, criteria, parameters::no_reset_c3t3(), parameters::no_perturb(),
                      parameters::no_exude(), parameters::no_odt(), parameters::no_lloyd());
  if (settings.optimise_seconds <= 0) return;
  CGAL::perturb_mesh_3(complex, domain, parameters::time_limit = settings.optimise_seconds);
  CGAL::exude_mesh_3(complex, parameters::time_limit = settings.optimise_seconds);
}

bool comes_before(const Vec3& a, const Vec3& b) {
  if (a.z != b.z) return a.z < b.z;
  if (a.y != b.y) return a.y < b.y;
  return a.x < b.x;
}

// The one way of writing a cell: positive volume, smallest node first, then the smallest of the others.
void make_canonical(Cell& cell, const std::vector<Vec3>& nodes) {
  std::sort(cell.begin(), cell.end());
  const auto at = [&](std::size_t i) { return nodes[static_cast<std::size_t>(cell[i])]; };
  if (dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) < 0) std::swap(cell[2], cell[3]);
}

// Volume over that of a regular tetrahedron with the longest edge: 1 at best, near 0 for slivers.
double roundness(const std::array<Vec3, 4>& p) {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) longest = std::max(longest, norm(p[i] - p[j]));
  return std::abs(dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0]))) * std::sqrt(2.0) / (longest * longest * longest);
}

// Mesh_3 labels a cell by its circumcentre, which in thin layers may lie across a surface and leaves notches. Where
// four of five points inside the cell agree on another label, that label holds. Slivers stay as they are: one more of
// them on a surface changes nothing but the worst angle.
int settled_label(const std::array<Vec3, 4>& p, int label, const ImplicitDomain& domain) {
  constexpr double min_roundness = 0.15;
  if (roundness(p) < min_roundness) return label;
  const Vec3 center = 0.25 * (p[0] + p[1] + p[2] + p[3]);
  const int at_center = domain.label_at(center);
  if (at_center == label) return label;
  int agreeing = 1;
  for (const auto& corner : p) agreeing += domain.label_at(0.5 * (center + corner)) == at_center;
  return agreeing >= 4 ? at_center : label;
}

struct RawCell {
  std::array<Vec3, 4> corners;
  int label;
};

std::vector<RawCell> labelled_cells(const Complex& complex, const ImplicitDomain& domain) {
  std::vector<RawCell> cells;
  const auto& triangulation = complex.triangulation();
  for (auto cell = triangulation.finite_cells_begin(); cell != triangulation.finite_cells_end(); ++cell) {
    RawCell raw;
    for (std::size_t i = 0; i < 4; ++i) raw.corners[i] = to_vec(cell->vertex(static_cast<int>(i))->point().point());
    raw.label = settled_label(raw.corners, complex.is_in_complex(cell) ? complex.subdomain_index(cell) : 0, domain);
    cells.push_back(raw);
  }
  return cells;
}

LabelledCells collect(const std::vector<RawCell>& raw) {
  LabelledCells result;
  auto& nodes = result.nodes_mm;
  for (const auto& cell : raw) nodes.insert(nodes.end(), cell.corners.begin(), cell.corners.end());
  std::sort(nodes.begin(), nodes.end(), comes_before);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());

  std::vector<std::pair<Cell, std::int32_t>> cells;
  for (const auto& cell : raw) {
    Cell ids;
    for (std::size_t i = 0; i < 4; ++i)
      ids[i] = static_cast<std::int32_t>(std::lower_bound(nodes.begin(), nodes.end(), cell.corners[i], comes_before) -
                                         nodes.begin());
    make_canonical(ids, nodes);
    cells.emplace_back(ids, cell.label);
  }
  std::sort(cells.begin(), cells.end());
  for (const auto& [ids, label] : cells) {
    result.cells.push_back(ids);
    result.label.push_back(label);
  }
  return result;
}

}  // namespace

LabelledCells mesh_implicit(const ImplicitDomain& domain, const DelaunaySettings& settings) {
  CGAL::get_default_random() = CGAL::Random(0);
  CGAL::Random random(0);
  const Domain cgal_domain = make_domain(domain, settings, random);
  Complex complex;
  insert_first_points(complex, cgal_domain, domain);
  refine(complex, cgal_domain, domain, settings);
  return collect(labelled_cells(complex, domain));
}

}  // namespace heartgen::adapters
