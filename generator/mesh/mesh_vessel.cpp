// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh/mesh_vessel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "generator/adapters/cgal_mesher.hpp"
#include "generator/image/components.hpp"
#include "generator/image/distance.hpp"
#include "generator/image/morphology.hpp"
#include "generator/mesh/curves.hpp"
#include "generator/mesh/domain.hpp"
#include "generator/mesh/improve_kept.hpp"
#include "generator/mesh/label_repair.hpp"
#include "generator/mesh/lattice_cells.hpp"
#include "generator/mesh/seeds.hpp"
#include "generator/mesh/sort_cells.hpp"
#include "generator/mesh/surfaces.hpp"
#include "generator/mesh/vessel_domain.hpp"
#include "generator/surface_fit/self_intersections.hpp"
#include "generator/tetmesh/remesh_worst.hpp"
#include "generator/tetmesh/repair.hpp"
#include "model/error.hpp"
#include "model/mathematics.hpp"

namespace heartgen::mesh {
namespace {

constexpr int rays_per_section = 96;
constexpr double spacing_per_edge = 0.8;
constexpr double smoothing_per_edge = 0.5;  // at most: smoothing shrinks a narrow lumen
constexpr double stub_edges = 1.5;
constexpr double wall_per_edge = 0.5;      // of a carotid: flow has its boundary layer there
constexpr std::int64_t crumb_cells = 30;   // pieces of so few cells are dropped
constexpr double min_radius_edges = 1.75;  // thinner branches are left out
constexpr std::size_t max_ends = 60;       // labels of stubs must fit a LabelSet
constexpr double min_component = 0.2;      // share of the largest component's voxels; smaller ones are dropped
// Where rays from the axis, in the plane of the cut, leave the lumen.
std::vector<CurvePoint> sample_rim(const VesselDomain& domain, const VesselEnd& end) {
  const Vec3 aside = std::abs(end.normal.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(end.normal, aside)), v = cross(end.normal, u);
  const double step = 0.25 * domain.wall_edge_mm;
  std::vector<Vec3> rim;
  double length = 0;
  for (int ray = 0; ray < rays_per_section; ++ray) {
    const double angle = 2 * std::numbers::pi * ray / rays_per_section;
    const Vec3 direction = math::cos(angle) * u + math::sin(angle) * v;
    double inside = 0;
    while (inside < end.reach_mm && in_lumen(domain, end.center_mm + (inside + step) * direction)) inside += step;
    double outside = inside + step;
    for (int i = 0; i < 24; ++i) {
      const double middle = 0.5 * (inside + outside);
      (in_lumen(domain, end.center_mm + middle * direction) ? inside : outside) = middle;
    }
    rim.push_back(end.center_mm + inside * direction);
    if (ray > 0) length += norm(rim[rim.size() - 1] - rim[rim.size() - 2]);
  }
  const double spacing = std::min(spacing_per_edge * domain.wall_edge_mm, length / 10);
  std::vector<CurvePoint> samples;
  samples.reserve(rim.size());
  for (const auto& p : rim) samples.push_back({p, spacing});
  return samples;
}

adapters::ImplicitDomain implicit_vessel(const VesselDomain& domain) {
  adapters::ImplicitDomain implicit;
  implicit.label_at = [&domain](const Vec3& p) { return vessel_label_at(domain, p); };
  implicit.edge_mm = [&domain](const Vec3& p) { return vessel_edge_at(domain, p); };
  const auto box = box_of(domain);
  implicit.box_min_mm = box.low_mm;
  implicit.box_max_mm = box.high_mm;
  LabelVolume voxels(domain.lumen.grid);
  voxels.voxels = domain.lumen.voxels;
  implicit.surface_points_mm =
      surface_seeds(voxels, implicit.label_at, [&domain](const Vec3&) { return 0.4 * domain.wall_edge_mm; });
  std::vector<CurvePoint> samples;
  for (const auto& end : domain.ends) {
    const auto rim = sample_rim(domain, end);
    samples.insert(samples.end(), rim.begin(), rim.end());
    // The far end of the stub needs vertices too, or refinement may never see the thin stub.
    const Vec3 along = domain.stub_mm * end.normal;
    implicit.surface_points_mm.push_back(end.center_mm + along);
    for (std::size_t r = 0; r < rim.size(); r += rays_per_section / 8)
      implicit.surface_points_mm.push_back(rim[r].position_mm + along);
  }
  implicit.curve_balls = balls_along(samples);
  return implicit;
}

LabelSet only_lumen() {
  LabelSet inside{};
  inside[lumen_label] = true;
  return inside;
}

LabelledCells delaunay_vessel(const VesselDomain& domain) {
  auto cells = adapters::mesh_implicit(implicit_vessel(domain), {});
  const LabelSet inside = only_lumen();
  repair_labels(cells.nodes_mm, cells.cells, cells.label, std::span(&inside, 1), crumb_cells);
  improve_kept(cells, lumen_label + 1);
  return cells;
}

// Stubs are one material, and told apart afterwards.
LabelledCells lattice_vessel(const VesselDomain& domain) {
  const LabelSet inside = only_lumen();
  const auto materials = materials_of(domain);
  auto complex = lattice_complex(materials, std::span(&inside, 1), crumb_cells);
  tetmesh::RepairSettings repairing;
  repairing.may_relabel = false;  // it would take cells out of a cut
  constexpr int rounds = 3;       // what would flatten a cell has room after a repair
  for (int round = 0; round < rounds; ++round) {
    const auto off = flatten_cuts(complex, domain);
    tetmesh::repair(complex, materials, repairing);
    if (off == 0) break;
  }
  tetmesh::remesh_worst(complex, materials, repairing, kept_quality, tetmesh::OnFailure::go_on);
  surface_fit::resolve_self_intersections(complex, repairing.least);
  tetmesh::compress(complex);
  auto cells = collect(complex, domain.lumen.grid);
  for (std::size_t c = 0; c < cells.cells.size(); ++c) {
    if (cells.label[c] != stub_label) continue;
    Vec3 center;
    for (const auto n : cells.cells[c]) center += 0.25 * cells.nodes_mm[static_cast<std::size_t>(n)];
    const int end = end_beyond(domain, center);
    cells.label[c] = stub_label + (end >= 0 ? end : static_cast<int>(nearest_end(domain, center)));
  }
  return cells;
}

// The box around the larger components, as a label map.
LabelVolume cropped(const Mask& lumen, Region vessel) {
  const auto components = image::connected_components(lumen);
  const auto& counts = components.voxel_count;
  const auto largest = counts.size() > 1 ? *std::max_element(counts.begin() + 1, counts.end()) : 0;
  const auto keeps = [&](std::int32_t c) {
    return static_cast<double>(counts[static_cast<std::size_t>(c)]) >= min_component * static_cast<double>(largest);
  };
  Index3 low = lumen.grid.size, high{-1, -1, -1};
  const auto for_set = [&](const auto& visit) {
    std::size_t voxel = 0;
    for (std::int64_t k = 0; k < lumen.grid.size[2]; ++k)
      for (std::int64_t j = 0; j < lumen.grid.size[1]; ++j)
        for (std::int64_t i = 0; i < lumen.grid.size[0]; ++i, ++voxel)
          if (const auto c = components.label.voxels[voxel]; c > 0 && keeps(c)) visit(Index3{i, j, k});
  };
  for_set([&](const Index3& p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  });
  if (largest == 0)
    throw UserError(fmt::format("the mask of region {} is empty", region_name(tag(vessel))), "mesh",
                    fmt::format("take \"{}\" out of meshes, or check its seed", region_name(tag(vessel))));
  constexpr std::int64_t margin = 6;
  Grid grid = lumen.grid;
  Vec3 first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::max<std::int64_t>(0, low[axis] - margin);
    grid.size[axis] = std::min(lumen.grid.size[axis], high[axis] + margin + 1) - low[axis];
    first[static_cast<int>(axis)] = static_cast<double>(low[axis]);
  }
  grid.origin_mm = lps_from_index(lumen.grid, first);
  LabelVolume labels(grid);
  for_set([&](const Index3& p) { labels(p[0] - low[0], p[1] - low[1], p[2] - low[2]) = tag(vessel); });
  return labels;
}

// Without the branches that cells of the wanted size cannot fill; everything where all would go.
Mask without_thin_branches(const Mask& lumen, double min_radius_mm) {
  const auto& s = lumen.grid.spacing_mm;
  const Mask wide = image::open(lumen, min_radius_mm);
  if (image::count(wide) == 0) return lumen;
  return image::intersect(lumen, image::dilate(wide, 1.01 * std::max({s.x, s.y, s.z})));
}

VesselDomain vessel_domain(const Mask& lumen, Region vessel, const MeshSettings& settings) {
  const bool is_trachea = vessel == Region::trachea;
  VesselDomain domain;
  domain.vessel = vessel;
  domain.edge_mm = is_trachea ? settings.trachea_edge_mm : settings.carotid_edge_mm;
  if (!(domain.edge_mm > 0) || !std::isfinite(domain.edge_mm))
    throw UserError(fmt::format("{}_edge_mm is {}", region_name(tag(vessel)), domain.edge_mm), "recipe, [mesh]",
                    "it must be a positive number");
  domain.wall_edge_mm = (is_trachea ? 1 : wall_per_edge) * domain.edge_mm;
  domain.stub_mm = stub_edges * domain.edge_mm;
  const double smoothing_mm = std::min(settings.smoothing_mm, smoothing_per_edge * domain.wall_edge_mm);
  domain.lumen =
      make_domain(cropped(without_thin_branches(lumen, min_radius_edges * domain.wall_edge_mm), vessel), smoothing_mm);
  Mask smooth(domain.lumen.grid);
  for (std::size_t v = 0; v < smooth.voxels.size(); ++v) smooth.voxels[v] = domain.lumen.voxels[v] != 0;
  domain.distance_mm = image::signed_distance(smooth);
  domain.ends = find_vessel_ends(smooth);
  if (domain.ends.size() < 2 || domain.ends.size() > max_ends)
    throw UserError(fmt::format("region {} has {} open ends", region_name(tag(vessel)), domain.ends.size()), "mesh",
                    fmt::format("a vessel has 2 to {}; its mask is not a tube", max_ends));
  return domain;
}

}  // namespace

TetMesh mesh_vessel(const Mask& lumen, Region vessel, const MeshSettings& settings) {
  const auto domain = vessel_domain(lumen, vessel, settings);
  auto cells = settings.backend == "cgal" ? delaunay_vessel(domain) : lattice_vessel(domain);
  sort_cells(cells.nodes_mm, cells.cells, cells.label);
  auto mesh = assemble(
      cells, [](std::int32_t label) { return label == lumen_label; },
      [&](std::int32_t, std::int32_t other) {
        return other == 0 ? surface_between(vessel, Region::none) : end_surface_tag(vessel, other - lumen_label);
      });
  std::fill(mesh.region.begin(), mesh.region.end(), static_cast<std::int32_t>(tag(vessel)));
  for (int number = 1; number <= static_cast<int>(domain.ends.size()); ++number) {
    auto rim = rim_of(mesh, end_surface_tag(vessel, number));
    if (!rim.nodes.empty()) mesh.rims.push_back(std::move(rim));
  }
  return mesh;
}

}  // namespace heartgen::mesh
