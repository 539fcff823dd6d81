// SPDX-License-Identifier: GPL-3.0-or-later
// The lattice mesher on analytic domains: angles, distances, volumes, times, next to CGAL's Mesh_3.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "benchmarks/benchmarks.hpp"
#include "benchmarks/cgal_rows.hpp"
#include "benchmarks/complex_measures.hpp"
#include "benchmarks/mesh_domains.hpp"
#include "benchmarks/mesh_measures.hpp"
#include "generator/adapters/cgal_mesher.hpp"
#include "generator/mesh/lattice_cells.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/tetmesh/feature.hpp"
#include "model/mathematics.hpp"

namespace heartgen::benchmarks {
namespace {

using tetmesh::Complex;
using tetmesh::Materials;

// Of the domain of one material, on a fine grid whose cells are filled in part at the surface.
double exact_volume_of(const AnalyticDomain& domain) {
  constexpr double step = 0.25;
  const Vec3 box = domain.box_max_mm - domain.box_min_mm;
  const auto count = [&](int axis) { return static_cast<std::int64_t>(std::llround(box[axis] / step)); };
  std::vector<double> slices(static_cast<std::size_t>(count(2)), 0);
  parallel::parallel_for(0, count(2), [&](std::int64_t begin, std::int64_t end) {
    for (auto k = begin; k < end; ++k)
      for (std::int64_t j = 0; j < count(1); ++j)
        for (std::int64_t i = 0; i < count(0); ++i) {
          const Vec3 p = domain.box_min_mm + step * Vec3{static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5,
                                                         static_cast<double>(k) + 0.5};
          slices[static_cast<std::size_t>(k)] += std::clamp(0.5 + domain.fields[0](p) / step, 0.0, 1.0);
        }
  });
  double sum = 0;
  for (const double slice : slices) sum += slice;
  return sum * step * step * step;
}

/// As the product meshes; where a cell stays too bad, again with finer edges.
struct Meshed {
  Complex complex;
  int tries = 0;
  double edge_mm = 0;
};

Meshed mesh_of(AnalyticDomain domain, double min_deg, double greatest_deg, const mesh::LatticeAims& aims) {
  constexpr int refinements = 2;
  constexpr std::int64_t crumb_cells = 30;
  mesh::LabelSet inside{};
  for (std::size_t label = 1; label <= domain.fields.size(); ++label) inside[label] = true;
  Meshed meshed;
  for (int finer = 0; finer <= refinements; ++finer, domain.edge_mm *= 0.8) {
    mesh::LatticeReport report;
    meshed.complex = mesh::lattice_complex(materials_of(domain), std::span(&inside, 1), crumb_cells, &report, aims);
    for (const auto& [step, taken] : report.seconds) meshed.tries += step == "stuff" ? 1 : 0;
    meshed.edge_mm = domain.edge_mm;
    const auto angles = angles_of(meshed.complex);
    if (angles.least >= min_deg && angles.greatest <= greatest_deg) break;
  }
  return meshed;
}

double add_ventricles(Table& table) {
  const auto domain = ventricles(0.962);  // 1.25 M cells
  const auto materials = materials_of(domain);
  Meshed meshed;
  const double processor = processor_seconds();
  const double time = seconds([&] { meshed = mesh_of(domain, 0, 180, mesh::one_material); });
  const double used = processor_seconds() - processor;
  const auto& c = meshed.complex;
  const auto angles = angles_of(c);
  const auto distances = distances_of(c, materials);
  const auto cells = static_cast<double>(c.cells.size());
  const double exact = exact_volume_of(domain);
  const auto add = [&](const char* what, double value, const char* unit, const std::string& note) {
    table.push_back({"mesh-ventricles", fmt::format("one material: {}", what), value, unit, note});
  };
  add("cells", cells / 1e6, "M", "the thesis: 1.25");
  add("from level sets to the repaired mesh", time, "s", fmt::format("at most 2; {:.1f} s of processor time", used));
  add("speed", cells / time / 1e3, "k cells/s", "");
  add("least dihedral angle", angles.least, "degrees", "at least 30");
  add("greatest dihedral angle", angles.greatest, "degrees", "at most 143");
  add("faces to the level set, p99", distances.p99, "edges", "at most 0.1");
  add("faces to the level set, greatest", distances.greatest, "edges", "at most 0.3; the level set has creases");
  add("volume against the level set's", 100 * (volume_of(c, 1) / exact - 1), "%", "within 0.2");
  return cells / time;
}

// A coarser mesh: 1.25 M cells would take minutes, and speed per cell hardly depends on the size.
void add_cgal(Table& table, double our_cells_per_second) {
  const auto domain = ventricles(1.8);
  const auto materials = materials_of(domain);
  adapters::ImplicitDomain implicit;
  implicit.edge_mm = materials.edge_mm;
  implicit.box_min_mm = domain.box_min_mm - Vec3{1, 1, 1};
  implicit.box_max_mm = domain.box_max_mm + Vec3{1, 1, 1};
  implicit.label_at = [&](const Vec3& p) { return p.z < 0 ? 0 : materials.label_at(p); };
  const auto seeds = mesh_of(ventricles(6), 0, 180, {}).complex;
  for (std::size_t n = 0; n < seeds.nodes_mm.size(); ++n)
    if (tetmesh::is_constrained(seeds.touches[n])) implicit.surface_points_mm.push_back(seeds.nodes_mm[n]);
  add_cgal_rows(table, "mesh-ventricles", implicit, "its base is not kept flat", our_cells_per_second);
}

void add_random_walls(Table& table) {
  constexpr std::uint32_t domains = 200;
  constexpr double min_deg = 25, greatest_deg = 145;
  int good = 0, again = 0, broken = 0;
  Angles worst;
  for (std::uint32_t seed = 1; seed <= domains; ++seed) {
    const auto meshed = mesh_of(random_walls(seed), min_deg, greatest_deg, {});
    const auto angles = angles_of(meshed.complex);
    good += angles.least >= min_deg && angles.greatest <= greatest_deg;
    again += meshed.tries > 1;
    broken += !(angles.min_volume_mm3 > 0) || defects_of(meshed.complex) > 0;
    worst.least = std::min(worst.least, angles.least);
    worst.greatest = std::max(worst.greatest, angles.greatest);
  }
  const auto add = [&](const char* what, double value, const char* unit) {
    table.push_back(
        {"mesh-walls", fmt::format("{} random walls of three materials: {}", domains, what), value, unit, ""});
  };
  add("within [25, 145] degrees", good, "domains");
  add("that needed another try", again, "domains");
  add("inverted or not manifold", broken, "domains");
  add("least dihedral angle", worst.least, "degrees");
  add("greatest dihedral angle", worst.greatest, "degrees");
}

void add_scaling(Table& table) {
  double time_before = 0, bytes_before = 0, cells_before = 0;
  constexpr int sizes = 9;  // 100 k to 25 M cells
  constexpr double max_bytes_per_cell = 300;
  for (int doubling = 0; doubling < sizes; ++doubling) {
    const double edge = 2.27 * math::exp2(-doubling / 3.0);
    Meshed meshed;
    if (2 * cells_before * max_bytes_per_cell > free_bytes()) {
      table.push_back({"mesh-scaling", fmt::format("{:.0f} k cells: left out", 2 * cells_before / 1e3), 0, "",
                       fmt::format("{:.1f} GB of memory are free", free_bytes() / 1e9)});
      return;
    }
    start_peak();
    const double time = seconds([&] { meshed = mesh_of(ventricles(edge), 0, 180, {}); });
    const double bytes = peak_bytes(), cells = static_cast<double>(meshed.complex.cells.size());
    // Per doubling, whatever the sizes came to.
    const auto per_doubling = [&](double now, double before) {
      return math::pow(now / before, std::numbers::ln2 / math::log(cells / cells_before));
    };
    table.push_back(
        {"mesh-scaling", fmt::format("{:.0f} k cells", cells / 1e3), time, "s",
         cells_before == 0
             ? std::string{}
             : fmt::format("{:.0f} bytes/cell; twice the cells: {:.2f} times the time, {:.2f} times "
                           "the memory (at most 2.2)",
                           bytes / cells, per_doubling(time, time_before), per_doubling(bytes, bytes_before))});
    time_before = time, bytes_before = bytes, cells_before = cells;
  }
}

}  // namespace

Table bench_mesh_scaling(const Settings& settings, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;  // the meshers work on one rank
  parallel::set_thread_count(settings.threads);
  add_scaling(table);
  return table;
}

Table bench_mesh_ventricles(const Settings& settings, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;
  parallel::set_thread_count(settings.threads);
  const double our_cells_per_second = add_ventricles(table);
  parallel::set_thread_count(1);  // as many as CGAL uses: processor time is divided by them
  add_cgal(table, our_cells_per_second);
  parallel::set_thread_count(settings.threads);
  return table;
}

Table bench_mesh_walls(const Settings& settings, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;
  parallel::set_thread_count(settings.threads);
  add_random_walls(table);
  return table;
}

}  // namespace heartgen::benchmarks
