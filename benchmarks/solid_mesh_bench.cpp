// The walls of a label map as one material: lattice mesher and CGAL's Mesh_3 on the same level set.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "benchmarks/benchmarks.hpp"
#include "benchmarks/cgal_rows.hpp"
#include "benchmarks/complex_measures.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/lattice/feature.hpp"
#include "generator/lattice/octree.hpp"
#include "generator/mesh/domain.hpp"
#include "generator/mesh/lattice_cells.hpp"
#include "generator/mesh/solid.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heart::benchmarks {
namespace {

constexpr const char* bench = "mesh-myocardium";
constexpr double voxel_mm = 0.5, smoothing_mm = 0.8, thinnest_mm = 1;  // of the level set
constexpr double growth = 0.35;                                        // of edges, per mm of distance from the surface
constexpr double wanted_cells = 1.25e6;
constexpr double cgal_edges = 2;  // of ours: as many cells would take it minutes, and its speed per cell hardly changes
constexpr std::int64_t crumb_cells = 30;

LabelVolume labels_of(const Settings& settings) {
  if (!settings.labels.empty()) return adapters::read_labels(settings.labels);
  datasets::PhantomSettings phantom;
  phantom.size = settings.size;
  phantom.spacing_mm = settings.spacing_mm;
  phantom.variant = settings.variant;
  phantom.companions = phantom.fibers = false;
  return datasets::make_phantom(phantom).labels;
}

bool is_wall(std::uint8_t label) { return is_myocardium(static_cast<Region>(label)); }

mesh::Box box_of_walls(const LabelVolume& labels) {
  mesh::Box box;
  const auto& size = labels.grid.size;
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i)
        if (is_wall(labels(i, j, k))) box.add({i, j, k});
  return box;
}

LabelVolume cropped(const LabelVolume& labels, mesh::Box box) {
  constexpr std::int64_t margin = 8;
  Grid grid = labels.grid;
  Vec3 first;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::max<std::int64_t>(0, box.low[axis] - margin);
    grid.size[axis] = std::min(labels.grid.size[axis], box.high[axis] + margin + 1) - box.low[axis];
    first[static_cast<int>(axis)] = static_cast<double>(box.low[axis]);
  }
  grid.origin_mm = lps_from_index(labels.grid, first);
  LabelVolume part(grid);
  for (std::int64_t k = 0; k < grid.size[2]; ++k)
    for (std::int64_t j = 0; j < grid.size[1]; ++j)
      for (std::int64_t i = 0; i < grid.size[0]; ++i)
        part(i, j, k) = labels(i + box.low[0], j + box.low[1], k + box.low[2]);
  return part;
}

// Of the voxels that are not wholly on one side, the part that a plane at the centre's distance would leave.
double level_set_volume(const LevelSet& solid) {
  const auto& spacing = solid.grid.spacing_mm;
  const double width = std::cbrt(spacing.x * spacing.y * spacing.z);
  double sum = 0;
  for (const float value : solid.voxels) sum += std::clamp(0.5 - static_cast<double>(value) / width, 0.0, 1.0);
  return sum * solid.grid.voxel_volume_mm3();
}

/// Cells that the lattice puts into the solid, from its volume at each level of the octree.
double expected_cells(const LevelSet& solid, double edge_mm) {
  constexpr double coarser_from = 1.41;
  const double cube = edge_mm / lattice::mean_edge_per_cell;
  double sum = 0;
  for (const float value : solid.voxels) {
    if (value > 0) continue;
    double size = cube;
    const double wanted = (1 + growth * std::max(0.0, -static_cast<double>(value) / edge_mm - 1)) * cube;
    while (wanted > coarser_from * size) size *= 2;
    sum += lattice::cells_per_cube / (size * size * size);
  }
  return sum * solid.grid.voxel_volume_mm3();
}

double edge_for(const LevelSet& solid) {
  double low = 0.2, high = 10;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (expected_cells(solid, middle) > wanted_cells ? low : high) = middle;
  }
  return high;
}

LevelSet solid_of(const Settings& settings) {
  const auto labels = labels_of(settings);
  const auto box = box_of_walls(labels);
  if (box.empty()) throw UserError("the label map has no wall of the heart", "bench", "name another one");
  const auto domain = mesh::make_domain(cropped(labels, box), MeshSettings{});
  return mesh::solid_level_set(domain, is_myocardium, voxel_mm, smoothing_mm, thinnest_mm);
}

lattice::Complex meshed(const LevelSet& solid, double edge_mm, mesh::LatticeReport* report = nullptr) {
  mesh::LabelSet inside{};
  inside[1] = true;
  return mesh::lattice_complex(mesh::materials_of(solid, edge_mm, growth), std::span(&inside, 1), crumb_cells, report,
                               mesh::one_material);
}

double add_ours(Table& table, const LevelSet& solid, double edge_mm) {
  lattice::Complex c;
  mesh::LatticeReport report;
  const double processor = processor_seconds();
  const double time = seconds([&] { c = meshed(solid, edge_mm, &report); });
  const double used = processor_seconds() - processor;
  const auto angles = angles_of(c);
  const auto distances = distances_of(c, mesh::materials_of(solid, edge_mm, growth));
  const double volume = level_set_volume(solid), cells = static_cast<double>(c.cells.size());
  const auto add = [&](const std::string& what, double value, const char* unit, const std::string& note) {
    table.push_back({bench, what, value, unit, note});
  };
  add("cells", cells / 1e6, "M", fmt::format("edges of {:.3f} mm at the surface, {:.0f} ml", edge_mm, volume / 1e3));
  add("from level set to the repaired mesh", time, "s", fmt::format("at most 2; {:.1f} s of processor time", used));
  for (const auto& [step, taken] : report.seconds) add("  of it: " + step, taken, "s", "");
  add("least dihedral angle", angles.least, "degrees", "at least 30");
  add("greatest dihedral angle", angles.greatest, "degrees", "at most 143");
  add("faces to the level set, p99", distances.p99, "edges", "at most 0.1");
  add("faces to the level set, greatest", distances.greatest, "edges", "at most 0.3");
  add("volume against the level set's", 100 * (volume_of(c, 1) / volume - 1), "%", "within 0.2");
  add("edges and faces that are not manifold", static_cast<double>(defects_of(c)), "", "");
  return cells / time;
}

void add_cgal(Table& table, const LevelSet& solid, double edge_mm, double our_cells_per_second) {
  const auto materials = mesh::materials_of(solid, cgal_edges * edge_mm, growth);
  adapters::ImplicitDomain implicit;
  implicit.edge_mm = materials.edge_mm;
  implicit.box_min_mm = materials.box_min_mm - Vec3{1, 1, 1};
  implicit.box_max_mm = materials.box_max_mm + Vec3{1, 1, 1};
  implicit.label_at = [&](const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] < materials.box_min_mm[axis] || p[axis] > materials.box_max_mm[axis]) return 0;
    return materials.label_at(p);
  };
  const auto seeds = meshed(solid, 3 * cgal_edges * edge_mm);
  for (std::size_t n = 0; n < seeds.nodes_mm.size(); ++n)
    if (lattice::is_constrained(seeds.touches[n])) implicit.surface_points_mm.push_back(seeds.nodes_mm[n]);
  add_cgal_rows(table, bench, implicit, fmt::format("edges of {:.2f} mm", cgal_edges * edge_mm), our_cells_per_second);
}

}  // namespace

Table bench_mesh_myocardium(const Settings& settings, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;
  parallel::set_thread_count(settings.threads);
  const auto solid = solid_of(settings);
  const double edge_mm = edge_for(solid);
  const double our_cells_per_second = add_ours(table, solid, edge_mm);
  parallel::set_thread_count(1);  // as many as CGAL uses: processor time is divided by them
  add_cgal(table, solid, edge_mm, our_cells_per_second);
  parallel::set_thread_count(settings.threads);
  return table;
}

}  // namespace heart::benchmarks
