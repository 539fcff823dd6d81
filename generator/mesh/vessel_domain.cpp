// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/vessel_domain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace heartgen::mesh {
namespace {

constexpr double inner_growth = 0.35, outer_growth = 0.5;  // of the edge, per mm of distance from the wall

/// Voxel (0, 0, 0) is the origin of the lattice's axes.
Vec3 index_of(const Grid& grid, const Vec3& p) {
  return {p.x / grid.spacing_mm.x, p.y / grid.spacing_mm.y, p.z / grid.spacing_mm.z};
}

Vec3 lps_of(const Grid& grid, const Vec3& p) { return lps_from_index(grid, index_of(grid, p)); }

/// The lumen's wall; beyond the cut, that of the section continued along the axis.
tetmesh::Equation wall_at(const VesselDomain& domain, const Vec3& lps_mm, const VesselEnd* end) {
  const Vec3 beyond = end == nullptr ? Vec3{} : dot(lps_mm - end->center_mm, end->normal) * end->normal;
  std::array<SurfaceEquation, 2> found;
  const auto labels = tetmesh::bit_of(0) | tetmesh::bit_of(static_cast<int>(tag(domain.vessel)));
  equations_at(domain.lumen, labels, index_from_lps(domain.lumen.grid, lps_mm - beyond), found);
  if (end == nullptr) return {found[0].value, found[0].gradient};
  const Vec3 along = transposed(domain.lumen.grid.direction) * end->normal;
  return {found[0].value, found[0].gradient - dot(found[0].gradient, along) * along};
}

constexpr auto cut = tetmesh::bit_of(lumen_label) | tetmesh::bit_of(stub_label);

/// Cells that a repair gave to the other side of a cut go back.
void relabel_at_cuts(tetmesh::Complex& c, const VesselDomain& domain) {
  for (std::size_t t = 0; t < c.cells.size(); ++t) {
    const Cell& cell = c.cells[t];
    if (cell[0] < 0 || c.label[t] == 0) continue;
    if (std::none_of(cell.begin(), cell.end(), [&](std::int32_t n) { return (c.bits(n) & cut) == cut; })) continue;
    const Vec3 middle = 0.25 * (c.at(cell[0]) + c.at(cell[1]) + c.at(cell[2]) + c.at(cell[3]));
    const Vec3 at = lps_of(domain.lumen.grid, middle);
    const auto& end = domain.ends[nearest_end(domain, at)];
    c.label[t] = dot(at - end.center_mm, end.normal) > 0 ? stub_label : lumen_label;
  }
  for (auto& bits : c.touches)
    if ((bits & tetmesh::bit_of(0)) != 0) bits |= tetmesh::hull_bit;
  tetmesh::derive_touches(c);
}

}  // namespace

bool in_lumen(const VesselDomain& domain, const Vec3& lps_mm) {
  const Grid& grid = domain.lumen.grid;
  const Vec3 index = index_from_lps(grid, lps_mm);
  for (int axis = 0; axis < 3; ++axis)
    if (index[axis] < -0.5 || index[axis] > static_cast<double>(grid.size[static_cast<std::size_t>(axis)]) - 0.5)
      return false;
  return region_at(domain.lumen, index) != 0;
}

std::size_t nearest_end(const VesselDomain& domain, const Vec3& lps_mm) {
  const auto nearest =
      std::min_element(domain.ends.begin(), domain.ends.end(), [&](const VesselEnd& a, const VesselEnd& b) {
        return norm(lps_mm - a.center_mm) - a.reach_mm < norm(lps_mm - b.center_mm) - b.reach_mm;
      });
  return static_cast<std::size_t>(nearest - domain.ends.begin());
}

int end_beyond(const VesselDomain& domain, const Vec3& lps_mm) {
  for (std::size_t e = 0; e < domain.ends.size(); ++e) {
    const Vec3 from_cut = lps_mm - domain.ends[e].center_mm;
    if (dot(from_cut, domain.ends[e].normal) > 0 && norm(from_cut) <= domain.ends[e].reach_mm + domain.stub_mm)
      return static_cast<int>(e);
  }
  return -1;
}

int vessel_label_at(const VesselDomain& domain, const Vec3& lps_mm) {
  const int e = end_beyond(domain, lps_mm);
  if (e < 0) return in_lumen(domain, lps_mm) ? lumen_label : 0;
  const auto& end = domain.ends[static_cast<std::size_t>(e)];
  const double beyond = dot(lps_mm - end.center_mm, end.normal);
  return beyond < domain.stub_mm && in_lumen(domain, lps_mm - beyond * end.normal) ? stub_label + e : 0;
}

double vessel_edge_at(const VesselDomain& domain, const Vec3& lps_mm) {
  const double distance = sample_linear(domain.distance_mm, index_from_lps(domain.lumen.grid, lps_mm));
  if (distance <= 0) return std::min(domain.edge_mm, domain.wall_edge_mm - inner_growth * distance);
  return domain.wall_edge_mm + outer_growth * std::max(0.0, distance - domain.edge_mm);
}

VesselBox box_of(const VesselDomain& domain) {
  constexpr double infinite = std::numeric_limits<double>::max();
  VesselBox box{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
  const Grid& grid = domain.lumen.grid;
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i, ++voxel) {
        if (domain.lumen.voxels[voxel] == 0) continue;
        const Vec3 p = lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        for (int axis = 0; axis < 3; ++axis) {
          box.low_mm[axis] = std::min(box.low_mm[axis], p[axis]);
          box.high_mm[axis] = std::max(box.high_mm[axis], p[axis]);
        }
      }
  const auto& s = grid.spacing_mm;
  const double margin = domain.stub_mm + 2 * std::max({s.x, s.y, s.z});
  box.low_mm -= Vec3{margin, margin, margin};
  box.high_mm += Vec3{margin, margin, margin};
  return box;
}

tetmesh::Materials materials_of(const VesselDomain& domain) {
  const Grid& grid = domain.lumen.grid;
  tetmesh::Materials materials;
  const auto& s = grid.spacing_mm;
  const double margin = domain.stub_mm + 2 * domain.edge_mm + std::max({s.x, s.y, s.z});
  for (int axis = 0; axis < 3; ++axis) {
    materials.box_min_mm[axis] = -margin;
    materials.box_max_mm[axis] = static_cast<double>(grid.size[static_cast<std::size_t>(axis)] - 1) * s[axis] + margin;
  }
  materials.label_at = [&domain](const Vec3& p) {
    return std::min(vessel_label_at(domain, lps_of(domain.lumen.grid, p)), stub_label);
  };
  materials.edge_mm = [&domain](const Vec3& p) { return vessel_edge_at(domain, lps_of(domain.lumen.grid, p)); };
  materials.equations_at = [&domain](tetmesh::LabelBits labels, const Vec3& p, std::span<tetmesh::Equation> equations) {
    const Vec3 at = lps_of(domain.lumen.grid, p);
    const bool outside = (labels & tetmesh::bit_of(0)) != 0, stub = (labels & tetmesh::bit_of(stub_label)) != 0;
    const bool lumen = (labels & tetmesh::bit_of(lumen_label)) != 0;
    const VesselEnd& end = domain.ends[nearest_end(domain, at)];
    const double beyond = dot(at - end.center_mm, end.normal);
    const Vec3 along = transposed(domain.lumen.grid.direction) * end.normal;
    std::size_t count = 0;
    if (lumen && stub && count < equations.size()) equations[count++] = {beyond, along};
    if (!outside || count == equations.size()) return static_cast<int>(count);
    const auto wall = wall_at(domain, at, stub ? &end : nullptr);
    const double to_wall = std::abs(wall.value) / std::max(norm(wall.gradient), 1e-12);
    const bool is_cap = stub && !lumen && std::abs(beyond - domain.stub_mm) < to_wall;
    equations[count++] = is_cap ? tetmesh::Equation{beyond - domain.stub_mm, along} : wall;
    return static_cast<int>(count);
  };
  return materials;
}

std::int64_t flatten_cuts(tetmesh::Complex& c, const VesselDomain& domain) {
  relabel_at_cuts(c, domain);
  constexpr double min_quality = 0.1;  // what comes after can mend that
  std::int64_t off = 0;
  c.frozen.assign(c.nodes_mm.size(), 0);
  for (std::size_t n = 0; n < c.nodes_mm.size(); ++n) {
    const auto node = static_cast<std::int32_t>(n);
    if ((c.bits(node) & cut) != cut) continue;
    const Vec3 old = c.at(node), at = lps_of(domain.lumen.grid, old);
    const auto& end = domain.ends[nearest_end(domain, at)];
    const double beyond = dot(at - end.center_mm, end.normal);
    c.nodes_mm[n] = old - beyond * (transposed(domain.lumen.grid.direction) * end.normal);
    c.frozen[n] = 1;
    for (const auto t : c.star(node)) tetmesh::update_quality(c, t);
    if (tetmesh::worst_quality(c, c.star(node)) >= min_quality) continue;
    c.nodes_mm[n] = old;
    c.frozen[n] = 0;
    for (const auto t : c.star(node)) tetmesh::update_quality(c, t);
    off += std::abs(beyond) > 1e-3 * domain.edge_mm;
  }
  return off;
}

}  // namespace heartgen::mesh
