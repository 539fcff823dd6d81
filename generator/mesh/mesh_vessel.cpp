#include "generator/mesh/mesh_vessel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "generator/adapters/cgal_mesher.hpp"
#include "generator/mesh/curves.hpp"
#include "generator/mesh/domain.hpp"
#include "generator/mesh/improve.hpp"
#include "generator/mesh/seeds.hpp"
#include "generator/mesh/settle_labels.hpp"
#include "generator/mesh/surfaces.hpp"
#include "generator/segment/components.hpp"
#include "model/error.hpp"

namespace heart::mesh {
namespace {

constexpr int rays_per_section = 96;
constexpr double spacing_per_edge = 0.8;
constexpr double smoothing_per_edge = 0.5;  // at most: smoothing shrinks a narrow lumen
constexpr double stub_edges = 1.5;
constexpr std::int64_t crumb_cells = 30;  // pieces of so few cells are dropped
constexpr std::size_t most_ends = 60;     // labels of stubs must fit a LabelSet
constexpr double least_component = 0.2;   // share of the largest component's voxels; smaller ones are dropped
// Beyond end N the section is continued as a straight stub with label 1 + N, which is meshed and then dropped: the cut
// is an interface, whatever the shape of the tip behind it.
constexpr int lumen_label = 1;

struct VesselFunction {
  const MeshDomain* domain;
  const std::vector<VesselEnd>* ends;
  double stub_mm;

  bool in_lumen(const Vec3& lps_mm) const {
    const Vec3 index = index_from_lps(domain->grid, lps_mm);
    for (int axis = 0; axis < 3; ++axis)
      if (index[axis] < -0.5 ||
          index[axis] > static_cast<double>(domain->grid.size[static_cast<std::size_t>(axis)]) - 0.5)
        return false;
    return region_at(*domain, index) != 0;
  }
  int operator()(const Vec3& lps_mm) const {
    for (std::size_t e = 0; e < ends->size(); ++e) {
      const auto& end = (*ends)[e];
      const Vec3 from_cut = lps_mm - end.center_mm;
      const double beyond = dot(from_cut, end.normal);
      if (beyond <= 0 || norm(from_cut) > end.reach_mm + stub_mm) continue;
      const bool in_stub = beyond < stub_mm && in_lumen(lps_mm - beyond * end.normal);
      return in_stub ? lumen_label + 1 + static_cast<int>(e) : 0;
    }
    return in_lumen(lps_mm) ? lumen_label : 0;
  }
};

// Where rays from the axis, in the plane of the cut, leave the lumen.
std::vector<CurvePoint> sample_rim(const VesselFunction& function, const VesselEnd& end, double edge_mm) {
  const Vec3 aside = std::abs(end.normal.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(end.normal, aside)), v = cross(end.normal, u);
  const double step = 0.25 * edge_mm;
  std::vector<Vec3> rim;
  double length = 0;
  for (int ray = 0; ray < rays_per_section; ++ray) {
    const double angle = 2 * std::numbers::pi * ray / rays_per_section;
    const Vec3 direction = std::cos(angle) * u + std::sin(angle) * v;
    double inside = 0;
    while (inside < end.reach_mm && function.in_lumen(end.center_mm + (inside + step) * direction)) inside += step;
    double outside = inside + step;
    for (int i = 0; i < 24; ++i) {
      const double middle = 0.5 * (inside + outside);
      (function.in_lumen(end.center_mm + middle * direction) ? inside : outside) = middle;
    }
    rim.push_back(end.center_mm + inside * direction);
    if (ray > 0) length += norm(rim[rim.size() - 1] - rim[rim.size() - 2]);
  }
  const double spacing = std::min(spacing_per_edge * edge_mm, length / 10);
  std::vector<CurvePoint> samples;
  for (const auto& p : rim) samples.push_back({p, spacing});
  return samples;
}

adapters::ImplicitDomain implicit_vessel(const MeshDomain& domain, const VesselFunction& function,
                                         const std::vector<VesselEnd>& ends, double edge_mm) {
  adapters::ImplicitDomain implicit;
  implicit.label_at = function;
  implicit.edge_mm = [edge_mm](const Vec3&) { return edge_mm; };
  Vec3 low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
  LabelVolume voxels(domain.grid);
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < domain.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < domain.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < domain.grid.size[0]; ++i, ++voxel) {
        if (domain.voxels[voxel] == 0) continue;
        voxels.voxels[voxel] = domain.voxels[voxel];
        const Vec3 p =
            lps_from_index(domain.grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
        for (int axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], p[axis]);
          high[axis] = std::max(high[axis], p[axis]);
        }
      }
  const auto& s = domain.grid.spacing_mm;
  const double margin = function.stub_mm + 2 * std::max({s.x, s.y, s.z});
  implicit.box_min_mm = low - Vec3{margin, margin, margin};
  implicit.box_max_mm = high + Vec3{margin, margin, margin};
  implicit.surface_points_mm = surface_seeds(voxels, function, [edge_mm](const Vec3&) { return 0.4 * edge_mm; });
  std::vector<CurvePoint> samples;
  for (const auto& end : ends) {
    const auto rim = sample_rim(function, end, edge_mm);
    samples.insert(samples.end(), rim.begin(), rim.end());
    // The far end of the stub needs vertices too, or refinement may never see the thin stub.
    const Vec3 along = function.stub_mm * end.normal;
    implicit.surface_points_mm.push_back(end.center_mm + along);
    for (std::size_t r = 0; r < rim.size(); r += rays_per_section / 8)
      implicit.surface_points_mm.push_back(rim[r].position_mm + along);
  }
  implicit.curve_balls = balls_along(samples);
  return implicit;
}

// The box around the larger components, as a label map.
LabelVolume cropped(const Mask& lumen, Region vessel) {
  const auto components = segment::connected_components(lumen);
  const auto& counts = components.voxel_count;
  const auto largest = counts.size() > 1 ? *std::max_element(counts.begin() + 1, counts.end()) : 0;
  const auto keeps = [&](std::int32_t c) {
    return static_cast<double>(counts[static_cast<std::size_t>(c)]) >= least_component * static_cast<double>(largest);
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

}  // namespace

TetMesh mesh_vessel(const Mask& lumen, Region vessel, const MeshSettings& settings) {
  const bool is_trachea = vessel == Region::trachea;
  const double edge_mm = is_trachea ? settings.trachea_edge_mm : settings.carotid_edge_mm;
  if (!(edge_mm > 0) || !std::isfinite(edge_mm))
    throw UserError(fmt::format("{}_edge_mm is {}", region_name(tag(vessel)), edge_mm), "recipe, [mesh]",
                    "it must be a positive number");
  const auto labels = cropped(lumen, vessel);
  const auto domain = make_domain(labels, std::min(settings.smoothing_mm, smoothing_per_edge * edge_mm));
  Mask smooth(domain.grid);
  for (std::size_t v = 0; v < smooth.voxels.size(); ++v) smooth.voxels[v] = domain.voxels[v] != 0;
  const auto ends = find_vessel_ends(smooth);
  if (ends.size() < 2 || ends.size() > most_ends)
    throw UserError(fmt::format("region {} has {} open ends", region_name(tag(vessel)), ends.size()), "mesh",
                    fmt::format("a vessel has 2 to {}; its mask is not a tube", most_ends));
  const VesselFunction function{&domain, &ends, stub_edges * edge_mm};
  auto cells = adapters::mesh_implicit(implicit_vessel(domain, function, ends, edge_mm), {});
  LabelSet inside{};
  inside[lumen_label] = true;
  settle_labels(cells.nodes_mm, cells.cells, cells.label, std::span(&inside, 1), crumb_cells);
  improve(cells.nodes_mm, cells.cells, cells.label, lumen_label + 1, {});
  auto mesh = assemble(
      cells.nodes_mm, cells.cells, cells.label, [](std::int32_t label) { return label == lumen_label; },
      [&](std::int32_t, std::int32_t other) {
        return other == 0 ? surface_between(vessel, Region::none) : end_surface_tag(vessel, other - lumen_label);
      });
  std::fill(mesh.region.begin(), mesh.region.end(), static_cast<std::int32_t>(tag(vessel)));
  for (int number = 1; number <= static_cast<int>(ends.size()); ++number) {
    auto rim = rim_of(mesh, end_surface_tag(vessel, number));
    if (!rim.nodes.empty()) mesh.rims.push_back(std::move(rim));
  }
  return mesh;
}

}  // namespace heart::mesh
