// SPDX-License-Identifier: GPL-3.0-or-later
#include "validation/label_fidelity.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>
#include <set>

#include "generator/parallel/tasks.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "model/mesh_queries/voxels_in_cell.hpp"
#include "validation/criteria.hpp"
#include "validation/label_map.hpp"
#include "validation/region_topology.hpp"

namespace heartgen::validation {
namespace {

constexpr double mm3_per_ml = 1000;
constexpr double crumb_cells = 100;  // pieces of less than so many mean cells of their region are crumbs
constexpr double surely_kept = 2;    // crumbs

LabelVolume labels_at_voxels(const Grid& grid, const LabelAt& label_at) {
  LabelVolume labels(grid);
  parallel::parallel_for(0, grid.size[2], [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < grid.size[1]; ++j)
        for (std::int64_t i = 0; i < grid.size[0]; ++i)
          labels(i, j, k) = static_cast<std::uint8_t>(
              label_at(lps_from_index(grid, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)})));
  });
  return labels;
}

struct Rows {
  Report* report;
  std::string scope;
  void add(const std::string& metric, double value, const char* unit) const {
    report->push_back({"mesh", scope, metric, value, unit, {}, {}});
  }
  void count(const char* metric, std::int64_t value) const { add(metric, static_cast<double>(value), "count"); }
  void excess(const char* metric, std::int64_t value) const { count(metric, std::max<std::int64_t>(value, 0)); }
};

std::int64_t larger_than(const std::vector<double>& sizes, double minimum) {
  return std::count_if(sizes.begin(), sizes.end(), [&](double s) { return s > minimum; });
}

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Crumbs do not count: the mesher may drop them, and cut them off thin strands. Pieces that touch at edges or corners
/// of voxels (`separate_ml`: those that do not) may be one in the mesh.
void add_topology(const Rows& rows, const RegionTopology& mesh, const RegionTopology& labels,
                  const std::vector<double>& separate_ml, double crumb_ml) {
  const auto all = [](const RegionTopology& t) { return static_cast<std::int64_t>(t.components_ml.size()); };
  double crumbs = 0;
  for (const double v : labels.components_ml) crumbs += v < crumb_ml ? v : 0;
  rows.add("crumbs_of_labels", crumbs, "ml");
  const auto pieces = larger_than(mesh.components_ml, crumb_ml);
  rows.count("pieces", pieces);
  rows.count("pieces_of_labels", larger_than(labels.components_ml, crumb_ml));
  rows.excess("pieces_added", pieces - all(labels));
  // A region with a piece that is no crumb is lost when it has no cell. What is all crumbs may be left out.
  rows.excess("pieces_lost", larger_than(separate_ml, surely_kept * crumb_ml) - all(mesh));
  rows.count("handles", mesh.handles);
  rows.count("handles_of_labels", labels.handles);
  rows.excess("handles_added", mesh.handles - labels.handles);
  rows.count("cavities", mesh.cavities);
  rows.count("cavities_of_labels", labels.cavities);
  rows.excess("cavities_added", mesh.cavities - labels.cavities);
}

/// Volume below which pieces are crumbs, per label: of its cells, or of all cells where it has none (0 too).
std::array<double, 256> crumb_sizes(const TetMesh& mesh) {
  std::array<double, 256> volume{}, count{};
  double all = 0;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const double v = cell_volume_mm3(mesh, mesh.cells[c]) / mm3_per_ml;
    all += v;
    volume[static_cast<std::size_t>(mesh.region[c])] += v;
    ++count[static_cast<std::size_t>(mesh.region[c])];
  }
  const double mean = all / std::max(static_cast<double>(mesh.cells.size()), 1.0);
  std::array<double, 256> crumb_ml{};
  for (std::size_t label = 0; label < crumb_ml.size(); ++label)
    crumb_ml[label] = crumb_cells * (count[label] > 0 ? volume[label] / count[label] : mean);
  return crumb_ml;
}

std::set<std::int32_t> with_those_of(const LabelVolume& labels, std::set<std::int32_t> regions) {
  std::array<bool, 256> present{};
  for (const auto voxel : labels.voxels) present[voxel] = true;
  for (std::size_t region = 1; region < present.size(); ++region)
    if (present[region]) regions.insert(static_cast<std::int32_t>(region));
  return regions;
}

/// Voxels by label: of the map, of the mesh (the region of the cell that holds the voxel's centre), of both.
struct Overlap {
  std::array<std::int64_t, 256> in_labels{}, in_mesh{}, in_both{};
};

Overlap overlap_of(const TetMesh& mesh, const LabelVolume& labels) {
  LabelVolume of_mesh(labels.grid);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    std::array<Vec3, 4> corners;
    for (std::size_t n = 0; n < 4; ++n) corners[n] = mesh.nodes_mm[static_cast<std::size_t>(mesh.cells[c][n])];
    mesh_queries::for_voxels_in_cell(labels.grid, corners, [&](std::int64_t v, const auto&) {
      of_mesh.voxels[static_cast<std::size_t>(v)] = static_cast<std::uint8_t>(mesh.region[c]);
    });
  }
  Overlap overlap;
  for (std::size_t v = 0; v < labels.voxels.size(); ++v) {
    const auto ours = of_mesh.voxels[v], theirs = labels.voxels[v];
    ++overlap.in_mesh[ours];
    ++overlap.in_labels[theirs];
    overlap.in_both[theirs] += ours == theirs;
  }
  return overlap;
}

/// Middles of the regions: of the map's voxels and of the mesh's cells (LPS mm); what is empty stays at 0.
struct Centroids {
  std::array<Vec3, 256> of_labels{}, of_mesh{};
};

Centroids centroids_of(const TetMesh& mesh, const LabelVolume& labels) {
  Centroids sums;
  std::array<double, 256> voxels{}, mm3{};
  std::size_t v = 0;
  for (std::int64_t k = 0; k < labels.grid.size[2]; ++k)
    for (std::int64_t j = 0; j < labels.grid.size[1]; ++j)
      for (std::int64_t i = 0; i < labels.grid.size[0]; ++i, ++v) {
        const auto label = labels.voxels[v];
        sums.of_labels[label] += Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
        ++voxels[label];
      }
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto region = static_cast<std::size_t>(mesh.region[c]);
    const double volume = cell_volume_mm3(mesh, mesh.cells[c]);
    Vec3 corners;
    for (const auto n : mesh.cells[c]) corners += mesh.nodes_mm[static_cast<std::size_t>(n)];
    sums.of_mesh[region] += volume / 4 * corners;
    mm3[region] += volume;
  }
  for (std::size_t label = 0; label < voxels.size(); ++label) {
    if (voxels[label] > 0) sums.of_labels[label] = lps_from_index(labels.grid, sums.of_labels[label] / voxels[label]);
    if (mm3[label] > 0) sums.of_mesh[label] = sums.of_mesh[label] / mm3[label];
  }
  return sums;
}

/// A region that is a crumb as a whole has a volume only, no mesh of such cells can have its shape; unless it is lost.
void add_agreement(const Rows& rows, const RegionTopology& mesh, const Overlap& overlap, const Centroids& centroids,
                   std::uint8_t label, const Grid& grid, double crumb_ml) {
  const double volume_ml = sum_of(mesh.components_ml);
  const double label_ml = static_cast<double>(overlap.in_labels[label]) * grid.voxel_volume_mm3() / mm3_per_ml;
  rows.add("volume_of_labels", label_ml, "ml");
  if (volume_ml > 0 && std::max(volume_ml, label_ml) < crumb_ml) return;
  if (overlap.in_labels[label] > 0 && overlap.in_mesh[label] > 0)
    rows.add("centroid_shift", norm(centroids.of_mesh[label] - centroids.of_labels[label]), "mm");
  if (label_ml > 0) rows.add("volume_difference", 100 * (volume_ml / label_ml - 1), "%");
  const auto voxels = overlap.in_mesh[label] + overlap.in_labels[label];
  if (voxels > 0)
    rows.add("dice_with_labels", 2.0 * static_cast<double>(overlap.in_both[label]) / static_cast<double>(voxels), "1");
}

/// Half an edge is looked around in steps of a tenth: voxels tell no more.
constexpr SurfaceSearch among_voxels{0.25, 0.1};

}  // namespace

Report check_against_labels(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                            const LabelVolume& labels, const ValidationSettings& settings) {
  Report report;
  const auto crumb_ml = crumb_sizes(mesh);
  const auto label_at = [&](const Vec3& lps_mm) { return label_between_voxels(labels, lps_mm); };
  const auto distances = surface_distances(mesh, faces, labels, label_at, crumb_ml, among_voxels);
  Overlap overlap;
  Centroids centroids;
  std::map<std::int32_t, RegionTopology> topologies;
  const std::array<std::function<void()>, 2> tasks{[&] { topologies = region_topologies(mesh, faces); },
                                                   [&] {
                                                     overlap = overlap_of(mesh, labels);
                                                     centroids = centroids_of(mesh, labels);
                                                   }};
  parallel::run_tasks(tasks);
  add_distance_rows(mesh_name, "to_labels", distances.from_mesh, 0, report);
  add_distance_rows(mesh_name, "from_labels", distances.to_mesh, 0, report);
  for (const auto region : with_those_of(labels, {mesh.region.begin(), mesh.region.end()})) {
    const Rows rows{&report, mesh_name + "/" + region_name(region)};
    const auto label = static_cast<std::uint8_t>(region);
    add_agreement(rows, topologies[region], overlap, centroids, label, labels.grid, crumb_ml[label]);
    if (is_myocardium(static_cast<Region>(region)) || is_blood(static_cast<Region>(region)))
      add_topology(rows, topologies[region], region_topology(labels, label), separate_pieces_ml(labels, label),
                   crumb_ml[label]);
    add_distance_rows(rows.scope, "to_labels", distances.from_mesh, region, report);
    add_distance_rows(rows.scope, "from_labels", distances.to_mesh, region, report);
  }
  return judged(std::move(report), settings);
}

Report check_against_level_sets(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                                const Grid& grid, const LabelAt& label_at, const ValidationSettings& settings) {
  Report report;
  const auto labels = labels_at_voxels(grid, label_at);
  const auto distances = surface_distances(mesh, faces, labels, label_at, crumb_sizes(mesh));
  add_distance_rows(mesh_name, "to_level_set", distances.from_mesh, 0, report);
  add_distance_rows(mesh_name, "from_level_set", distances.to_mesh, 0, report);
  for (const auto region : with_those_of(labels, {mesh.region.begin(), mesh.region.end()})) {
    const std::string scope = mesh_name + "/" + region_name(region);
    add_distance_rows(scope, "to_level_set", distances.from_mesh, region, report);
    add_distance_rows(scope, "from_level_set", distances.to_mesh, region, report);
  }
  return judged(std::move(report), settings);
}

}  // namespace heartgen::validation
