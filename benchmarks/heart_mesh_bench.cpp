// SPDX-License-Identifier: GPL-3.0-or-later
// The walls of a label map as five regions: alone, next to CGAL's Mesh_3 on the same level sets, and with the blood.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "benchmarks/benchmarks.hpp"
#include "benchmarks/cgal_rows.hpp"
#include "benchmarks/label_measures.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/walls.hpp"
#include "generator/parallel/threads.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"

namespace heartgen::benchmarks {
namespace {

constexpr double wall_cells = 1.25e6;  // the thesis's

LabelVolume labels_of(const Settings& settings) {
  if (!settings.labels.empty()) return adapters::read_labels(settings.labels);
  phantom::PhantomSettings phantom;
  phantom.size = settings.size;
  phantom.spacing_mm = settings.spacing_mm;
  phantom.variant = settings.variant;
  phantom.companions = phantom.fibers = false;
  return phantom::make_phantom(phantom).labels;
}

/// Edges for as many cells in the walls; the share of what thin walls add is about the same in all hearts.
double heart_edge_for(const LabelVolume& labels, const Settings& asked) {
  if (asked.heart_edge_mm > 0) return asked.heart_edge_mm;
  constexpr double cells_per_cubed_edge = 8.93;
  double volume_mm3 = 0;
  for (const auto label : labels.voxels)
    if (is_myocardium(static_cast<Region>(label))) volume_mm3 += labels.grid.voxel_volume_mm3();
  return math::cbrt(cells_per_cubed_edge * volume_mm3 / wall_cells);
}

/// What one run took.
struct Run {
  double seconds = 0, processor_seconds = 0;
};

/// Several runs, fastest first: other work on the machine makes single ones slow. `forget` what the last one made,
/// which no user has beside the next, is not timed.
std::vector<Run> runs_of(int repeats, const std::function<void()>& forget, const std::function<void()>& work) {
  std::vector<Run> runs;
  for (int i = 0; i < repeats; ++i) {
    forget();
    const double processor = processor_seconds(), time = seconds(work);
    runs.push_back({time, processor_seconds() - processor});
  }
  std::ranges::sort(runs, {}, &Run::seconds);
  return runs;
}

/// The median's; returns it.
double add_time(Table& table, const char* bench, const std::vector<Run>& runs, double cells) {
  const auto& [time, used] = runs[runs.size() / 2];
  auto note =
      fmt::format("{:.1f} s of processor time; at most 2 for 1.25 M cells: {:.2f}", used, time * wall_cells / cells);
  if (runs.size() > 1)
    note += fmt::format("; {} runs took {:.2f} to {:.2f} s", runs.size(), runs.front().seconds, runs.back().seconds);
  table.push_back({bench, "from level sets to labelled mesh", time, "s", note});
  return time;
}

double add_walls(Table& table, const char* bench, const mesh::WallLevelSets& walls, const MeshSettings& settings) {
  constexpr int repeats = 5;
  TetMesh mesh;
  mesh::LatticeReport report;
  const auto forget = [&] {
    report = {};
    mesh = {};
  };
  const auto runs = runs_of(repeats, forget, [&] { mesh = mesh::mesh_walls(walls, settings, &report); });
  const auto cells = static_cast<double>(mesh.cells.size());
  table.push_back({bench, "cells", cells / 1e6, "M", fmt::format("edges of {:.2f} mm", settings.heart_edge_mm)});
  const double time = add_time(table, bench, runs, cells);
  add_quality(table, bench, mesh, report, {"at least 30", "at most 143"});
  const auto label_at = [&](const Vec3& p) { return mesh::wall_at(walls, p); };
  add_found_distances(table, bench, mesh, mesh::labels_of(walls), label_at);
  add_regions(table, bench, mesh, volumes_of(walls.domain.grid, label_at));
  return cells / time;
}

// A coarser mesh: as many cells would take it minutes, and its speed per cell hardly changes.
void add_cgal(Table& table, const char* bench, const mesh::WallLevelSets& walls, MeshSettings settings,
              double our_cells_per_second) {
  constexpr double coarser = 2, seeds_coarser = 3;
  settings.heart_edge_mm *= coarser;
  const double edge_mm = settings.heart_edge_mm;
  adapters::ImplicitDomain implicit;
  implicit.edge_mm = [edge_mm](const Vec3&) { return edge_mm; };
  implicit.label_at = [&walls](const Vec3& p) { return mesh::wall_at(walls, p); };
  settings.heart_edge_mm *= seeds_coarser;
  const auto seeds = mesh::mesh_walls(walls, settings);
  implicit.box_min_mm = implicit.box_max_mm = seeds.nodes_mm.front();
  for (const auto& face : seeds.faces)
    for (const auto n : face) {
      const Vec3& p = seeds.nodes_mm[static_cast<std::size_t>(n)];
      implicit.surface_points_mm.push_back(p);
      for (int axis = 0; axis < 3; ++axis) {
        implicit.box_min_mm[axis] = std::min(implicit.box_min_mm[axis], p[axis] - edge_mm);
        implicit.box_max_mm[axis] = std::max(implicit.box_max_mm[axis], p[axis] + edge_mm);
      }
    }
  add_cgal_rows(table, bench, implicit, fmt::format("edges of {:.2f} mm", edge_mm), our_cells_per_second);
}

// With the blood: it tells the endocardium of each chamber from the epicardium, and thin walls keep both their faces.
void add_heart(Table& table, const LabelVolume& labels, const Settings& asked) {
  const char* bench = "mesh-heart";
  MeshSettings settings;
  settings.heart_edge_mm = heart_edge_for(labels, asked);
  const auto heart = mesh::heart_only(labels);
  const auto domain = mesh::make_domain(heart, settings);
  TetMesh mesh;
  mesh::LatticeReport report;
  const auto runs = runs_of(
      1, [] {}, [&] { mesh = mesh::mesh_domain(domain, settings, &report); });
  const auto& regions = mesh.region;
  const auto cells = static_cast<double>(regions.size());
  const auto in_walls = static_cast<double>(
      std::count_if(regions.begin(), regions.end(), [](auto r) { return is_myocardium(static_cast<Region>(r)); }));
  table.push_back({bench, "cells", cells / 1e6, "M", fmt::format("edges of {:.2f} mm", settings.heart_edge_mm)});
  table.push_back({bench, "of them in the walls", in_walls / 1e6, "M", "five regions; the thesis: 1.25"});
  add_time(table, bench, runs, cells);
  add_quality(table, bench, mesh, report, {"at least 30", "at most 143"});
  const auto label_at = [&](const Vec3& p) { return mesh::region_at(domain, index_from_lps(domain.grid, p)); };
  add_found_distances(table, bench, mesh, heart, label_at);
  add_regions(table, bench, mesh, volumes_of(domain.grid, label_at));
}

}  // namespace

Table bench_mesh_myocardium(const Settings& settings, const parallel::Comm& comm) {
  const char* bench = "mesh-myocardium";
  Table table;
  if (!comm.is_root()) return table;
  parallel::set_thread_count(settings.threads);
  const auto labels = labels_of(settings);
  MeshSettings mesh_settings;
  mesh_settings.heart_edge_mm = heart_edge_for(labels, settings);
  const auto walls = mesh::wall_level_sets(labels, mesh_settings);
  const double our_cells_per_second = add_walls(table, bench, walls, mesh_settings);
  parallel::set_thread_count(1);  // as many as CGAL uses: processor time is divided by them
  add_cgal(table, bench, walls, mesh_settings, our_cells_per_second);
  parallel::set_thread_count(settings.threads);
  return table;
}

Table bench_mesh_heart(const Settings& settings, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;
  parallel::set_thread_count(settings.threads);
  add_heart(table, labels_of(settings), settings);
  return table;
}

}  // namespace heartgen::benchmarks
