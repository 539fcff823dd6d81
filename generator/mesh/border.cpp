// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/border.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "generator/mesh/size_field.hpp"
#include "generator/mesh/surfaces.hpp"
#include "generator/tetmesh/quality.hpp"
#include "model/labels.hpp"

namespace heartgen::mesh {
namespace {

constexpr double spacing_per_edge = 0.8;
constexpr double spacing_per_section = 0.5;  // of the square root of a section's area: about seven points around it

// A border slice of the voxel labels: constant index `last ? size-1 : 0` along `axis`; u and v are the other two axes.
struct Side {
  const MeshDomain* domain;
  std::size_t axis;
  bool last;
  std::size_t u() const { return (axis + 1) % 3; }
  std::size_t v() const { return (axis + 2) % 3; }
  std::int64_t size_u() const { return domain->grid.size[u()]; }
  std::int64_t size_v() const { return domain->grid.size[v()]; }

  // Continuous index of a point of the border plane, half a voxel beyond the slice.
  Vec3 plane_index(double at_u, double at_v) const {
    Vec3 index;
    index[static_cast<int>(axis)] = last ? static_cast<double>(domain->grid.size[axis]) - 0.5 : -0.5;
    index[static_cast<int>(u())] = at_u;
    index[static_cast<int>(v())] = at_v;
    return index;
  }
  std::uint8_t label(std::int64_t at_u, std::int64_t at_v) const {
    Index3 at;
    at[axis] = last ? domain->grid.size[axis] - 1 : 0;
    at[u()] = at_u;
    at[v()] = at_v;
    return domain->voxels[static_cast<std::size_t>(domain->grid.offset(at[0], at[1], at[2]))];
  }
};

// Area (mm^2) of the connected section of one label around every pixel of the side.
std::vector<double> section_areas(const Side& side) {
  const std::int64_t nu = side.size_u(), nv = side.size_v();
  const auto& spacing = side.domain->grid.spacing_mm;
  const double pixel = spacing[static_cast<int>(side.u())] * spacing[static_cast<int>(side.v())];
  std::vector<double> area(static_cast<std::size_t>(nu * nv), 0);
  for (std::int64_t seed = 0; seed < nu * nv; ++seed) {
    if (area[static_cast<std::size_t>(seed)] != 0) continue;
    std::vector<std::int64_t> section{seed};
    area[static_cast<std::size_t>(seed)] = pixel;
    const auto label = side.label(seed % nu, seed / nu);
    const auto visit = [&](std::int64_t u, std::int64_t v) {
      if (u < 0 || v < 0 || u >= nu || v >= nv || area[static_cast<std::size_t>(v * nu + u)] != 0) return;
      if (side.label(u, v) != label) return;
      area[static_cast<std::size_t>(v * nu + u)] = pixel;
      section.push_back(v * nu + u);
    };
    for (std::size_t next = 0; next < section.size(); ++next) {
      const std::int64_t u = section[next] % nu, v = section[next] / nu;
      visit(u - 1, v), visit(u + 1, v), visit(u, v - 1), visit(u, v + 1);
    }
    for (const auto at : section) area[static_cast<std::size_t>(at)] = pixel * static_cast<double>(section.size());
  }
  return area;
}

void sample_side(const Side& side, const Volume<float>& sizes, std::vector<CurvePoint>& samples) {
  const auto& domain = *side.domain;
  const std::int64_t nu = side.size_u(), nv = side.size_v();
  const auto areas = section_areas(side);
  const auto area = [&](std::int64_t u, std::int64_t v) { return areas[static_cast<std::size_t>(v * nu + u)]; };
  const auto add = [&](const Vec3& index, double section_area) {
    const Vec3 p = lps_from_index(domain.grid, index);
    const double spacing =
        std::min(spacing_per_edge * edge_at(sizes, p), spacing_per_section * std::sqrt(section_area));
    samples.push_back({p, spacing});
  };
  const auto cross = [&](std::int64_t u, std::int64_t v, std::int64_t du, std::int64_t dv) {
    if (u + du >= nu || v + dv >= nv || side.label(u, v) == side.label(u + du, v + dv)) return;
    double low = 0, high = 1;
    const auto at = [&](double t) {
      return side.plane_index(static_cast<double>(u) + t * static_cast<double>(du),
                              static_cast<double>(v) + t * static_cast<double>(dv));
    };
    for (int step = 0; step < 20; ++step) {
      const double middle = 0.5 * (low + high);
      (region_at(domain, at(middle)) == side.label(u, v) ? low : high) = middle;
    }
    add(at(0.5 * (low + high)), std::min(area(u, v), area(u + du, v + dv)));
  };
  for (std::int64_t v = 0; v < nv; ++v)
    for (std::int64_t u = 0; u < nu; ++u) {
      cross(u, v, 1, 0);
      cross(u, v, 0, 1);
      if (side.label(u, v) == 0) continue;
      const auto fu = static_cast<double>(u), fv = static_cast<double>(v);
      if (u == 0) add(side.plane_index(-0.5, fv), area(u, v));
      if (u == nu - 1) add(side.plane_index(fu + 0.5, fv), area(u, v));
      if (v == 0) add(side.plane_index(fu, -0.5), area(u, v));
      if (v == nv - 1) add(side.plane_index(fu, fv + 0.5), area(u, v));
    }
}

// Index coordinate of the border plane that lies across `beyond` (a place in the layer) along its farthest axis.
struct BorderPlane {
  int axis = 0;
  double at = 0;
};

BorderPlane plane_across(const Grid& grid, const Vec3& beyond_index) {
  BorderPlane plane;
  double farthest = -std::numeric_limits<double>::max();
  for (int axis = 0; axis < 3; ++axis) {
    const double last = static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5;
    for (const auto& [at, distance] : {std::pair{-0.5, -0.5 - beyond_index[axis]}, {last, beyond_index[axis] - last}})
      if (distance * grid.spacing_mm[axis] > farthest) {
        farthest = distance * grid.spacing_mm[axis];
        plane = {axis, at};
      }
  }
  return plane;
}

bool is_kept(std::int32_t label) { return label > 0 && label < beyond_border; }

// Where each node should lie: on the planes of its faces against the layer, and not beyond any plane.
std::vector<Vec3> border_targets(const Grid& grid, const std::vector<Vec3>& nodes, const std::vector<Cell>& cells,
                                 const std::vector<std::int32_t>& label) {
  std::vector<Vec3> target = nodes;
  std::vector<std::uint8_t> used(nodes.size(), 0);
  const auto put_on = [&](std::int32_t node, const BorderPlane& plane) {
    auto& p = target[static_cast<std::size_t>(node)];
    Vec3 index = index_from_lps(grid, p);
    index[plane.axis] = plane.at;
    p = lps_from_index(grid, index);
  };
  for (const auto& face : cell_faces(cells)) {
    if (face.other < 0) continue;
    const auto a = label[static_cast<std::size_t>(face.cell)], b = label[static_cast<std::size_t>(face.other)];
    if (!(is_kept(a) && b >= beyond_border) && !(is_kept(b) && a >= beyond_border)) continue;
    Vec3 center;
    for (const auto n : cells[static_cast<std::size_t>(a >= beyond_border ? face.cell : face.other)])
      center += nodes[static_cast<std::size_t>(n)] / 4;
    const auto plane = plane_across(grid, index_from_lps(grid, center));
    for (const auto n : face.nodes) put_on(n, plane);
  }
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (is_kept(label[c]))
      for (const auto n : cells[c]) used[static_cast<std::size_t>(n)] = 1;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    for (int axis = 0; used[n] && axis < 3; ++axis) {
      const double last = static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5;
      const double at = index_from_lps(grid, target[n])[axis];
      if (at < -0.5 || at > last) put_on(static_cast<std::int32_t>(n), {axis, at < -0.5 ? -0.5 : last});
    }
  return target;
}

}  // namespace

double beyond_border_mm(const Grid& grid, const Vec3& index) {
  double beyond = -std::numeric_limits<double>::max();
  for (int axis = 0; axis < 3; ++axis) {
    const double last = static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5;
    beyond = std::max(beyond, std::max(-0.5 - index[axis], index[axis] - last) * grid.spacing_mm[axis]);
  }
  return beyond;
}

std::vector<CurvePoint> border_curves(const MeshDomain& domain, const Volume<float>& sizes) {
  std::vector<CurvePoint> samples;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool last : {false, true}) sample_side({&domain, axis, last}, sizes, samples);
  // Sections too small to walk around are left to the surface's own criteria.
  const auto& spacing = domain.grid.spacing_mm;
  const double least = std::min({spacing.x, spacing.y, spacing.z});
  std::erase_if(samples, [&](const CurvePoint& p) { return p.spacing_mm < 1.5 * least; });
  return samples;
}

std::vector<Vec3> border_layer_points(const MeshDomain& domain, double layer_mm, double apart_mm) {
  std::vector<Vec3> points;
  const auto& grid = domain.grid;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool last : {false, true}) {
      const Side side{&domain, axis, last};
      const auto step = [&](std::size_t along) {
        return std::max<std::int64_t>(1, std::llround(apart_mm / grid.spacing_mm[static_cast<int>(along)]));
      };
      const double offset = (last ? 1 : -1) * 0.999 * layer_mm / grid.spacing_mm[static_cast<int>(axis)];
      for (std::int64_t v = 0; v < side.size_v(); v += step(side.v()))
        for (std::int64_t u = 0; u < side.size_u(); u += step(side.u())) {
          if (side.label(u, v) == 0) continue;
          Vec3 index = side.plane_index(static_cast<double>(u), static_cast<double>(v));
          index[static_cast<int>(axis)] += offset;
          points.push_back(lps_from_index(grid, index));
        }
    }
  return points;
}

std::int64_t flatten_border(const Grid& grid, std::vector<Vec3>& nodes_mm, const std::vector<Cell>& cells,
                            const std::vector<std::int32_t>& label) {
  constexpr double near_mm = 1e-6;
  constexpr double enough = 0.139;  // sine of 8 degrees
  const auto target = border_targets(grid, nodes_mm, cells, label);
  std::vector<std::vector<std::int32_t>> star(nodes_mm.size());
  const auto is_off = [&](std::int32_t n) {
    return norm(target[static_cast<std::size_t>(n)] - nodes_mm[static_cast<std::size_t>(n)]) > near_mm;
  };
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (is_kept(label[c]))
      for (const auto n : cells[c])
        if (is_off(n)) star[static_cast<std::size_t>(n)].push_back(static_cast<std::int32_t>(c));
  const auto worst = [&](const std::vector<std::int32_t>& around) {
    double least = 1;
    for (const auto c : around) {
      std::array<Vec3, 4> p;
      for (std::size_t i = 0; i < 4; ++i)
        p[i] = nodes_mm[static_cast<std::size_t>(cells[static_cast<std::size_t>(c)][i])];
      least = std::min(least, tetmesh::cell_quality(p[0], p[1], p[2], p[3]));
    }
    return least;
  };
  std::int64_t left = 0;
  for (std::size_t n = 0; n < nodes_mm.size(); ++n) {
    if (star[n].empty()) continue;
    const Vec3 old = nodes_mm[n];
    const double before = worst(star[n]);
    nodes_mm[n] = target[n];
    if (const double after = worst(star[n]); after > 0 && after >= std::min(before, enough)) continue;
    nodes_mm[n] = old;
    ++left;
  }
  return left;
}

std::int32_t surface_at_border(std::int32_t surface) {
  for (const Region artery : {Region::aorta, Region::pulmonary_artery}) {
    const auto end = *surface_from_name(region_name(tag(artery)) + "_end");
    if (surface == surface_between(artery, Region::none) || surface == end) return end;
  }
  return *surface_from_name("fov_cut");
}

void label_border_faces(TetMesh& mesh, const Grid& grid) {
  constexpr double near_voxels = 1e-4;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (int axis = 0; axis < 3; ++axis) {
      const double last = static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5;
      std::array<double, 3> at;
      for (std::size_t i = 0; i < 3; ++i)
        at[i] = index_from_lps(grid, mesh.nodes_mm[static_cast<std::size_t>(mesh.faces[f][i])])[axis];
      for (const double plane : {-0.5, last})
        if (std::all_of(at.begin(), at.end(), [&](double v) { return std::abs(v - plane) < near_voxels; }))
          mesh.surface[f] = surface_at_border(mesh.surface[f]);
    }
}

}  // namespace heartgen::mesh
