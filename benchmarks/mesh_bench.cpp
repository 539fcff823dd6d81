// The lattice mesher on analytic domains: angles, distances, volumes, times, next to CGAL's Mesh_3.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "benchmarks/benchmarks.hpp"
#include "benchmarks/mesh_domains.hpp"
#include "benchmarks/mesh_measures.hpp"
#include "generator/adapters/cgal_mesher.hpp"
#include "generator/lattice/balance.hpp"
#include "generator/lattice/feature.hpp"
#include "generator/lattice/repair.hpp"
#include "generator/lattice/stuff.hpp"
#include "generator/parallel/threads.hpp"

namespace heart::benchmarks {
namespace {

using lattice::Complex;
using lattice::Materials;

Angles angles_of_complex(const Complex& c) {
  return angles_of(c.nodes_mm, c.cells, [&](std::size_t i) { return c.cells[i][0] >= 0; });
}

double volume_of(const Complex& c, int label) {
  double sum = 0;
  for (std::size_t i = 0; i < c.cells.size(); ++i) {
    const auto& cell = c.cells[i];
    if (cell[0] >= 0 && c.label[i] == label)
      sum +=
          dot(c.at(cell[1]) - c.at(cell[0]), cross(c.at(cell[2]) - c.at(cell[0]), c.at(cell[3]) - c.at(cell[0]))) / 6;
  }
  return sum;
}

// Of the domain of one material, on a fine grid whose cells are filled in part at the surface.
double volume_of(const AnalyticDomain& domain) {
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

// Of the outer faces' centres to the surface of one material, to first order, in shares of the face's mean edge.
Distances distances_of(const Complex& c, const Materials& materials) {
  std::vector<double> found;
  for (std::size_t t = 0; t < c.cells.size(); ++t) {
    const auto& cell = c.cells[t];
    for (std::size_t i = 0; i < 4 && cell[0] >= 0; ++i) {
      const std::array n{cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]};
      const lattice::LabelBits bits = c.bits(n[0]) & c.bits(n[1]) & c.bits(n[2]);
      if (std::popcount(bits) < 2 || (bits & lattice::side_bits) != 0) continue;
      if (lattice::cells_at_face(c, n[0], n[1], n[2])[1] >= 0) continue;
      const Vec3 a = c.at(n[0]), b = c.at(n[1]), d = c.at(n[2]);
      const double edge = (norm(b - a) + norm(d - b) + norm(a - d)) / 3;
      found.push_back(lattice::distance_to(lattice::feature_at(materials, 3, (a + b + d) / 3)) / edge);
    }
  }
  return summary_of(std::move(found));
}

/// Stuffed, repaired and balanced; where a cell stays too bad, once more with shorter snaps, then with finer edges.
struct Meshed {
  Complex complex;
  int tries = 0;
  double edge_mm = 0;
};

Meshed mesh_of(AnalyticDomain domain, double least_deg, double greatest_deg, const lattice::RepairSettings& repairing) {
  constexpr std::array reaches{0.5, 0.42};
  constexpr int refinements = 2;
  Meshed meshed;
  for (int finer = 0; finer <= refinements; ++finer, domain.edge_mm *= 0.8)
    for (const double reach : reaches) {
      lattice::StuffSettings stuffing;
      stuffing.edge_reach = reach;
      const auto materials = materials_of(domain);
      auto& c = meshed.complex = lattice::stuff(materials, stuffing);
      lattice::derive_touches(c);
      lattice::compress(c);
      lattice::repair(c, materials, repairing);
      lattice::balance_surfaces(c, materials, repairing.least);
      lattice::compress(c);
      ++meshed.tries;
      meshed.edge_mm = domain.edge_mm;
      const auto angles = angles_of_complex(c);
      if (angles.least >= least_deg && angles.greatest <= greatest_deg) return meshed;
    }
  return meshed;
}

// One material is worth the last degrees.
lattice::RepairSettings thorough() {
  lattice::RepairSettings settings;
  settings.least = settings.goal;
  return settings;
}

// Edges with other than two outer faces, and faces with more than two cells.
std::int64_t defects_of(const Complex& c) {
  std::vector<Face> faces;
  for (const auto& cell : c.cells)
    for (std::size_t i = 0; i < 4 && cell[0] >= 0; ++i) {
      faces.push_back({cell[(i + 1) % 4], cell[(i + 2) % 4], cell[(i + 3) % 4]});
      std::sort(faces.back().begin(), faces.back().end());
    }
  std::sort(faces.begin(), faces.end());
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  std::int64_t defects = 0;
  for (std::size_t f = 0; f < faces.size();) {
    std::size_t next = f + 1;
    while (next < faces.size() && faces[next] == faces[f]) ++next;
    defects += next - f > 2;
    if (next == f + 1)
      for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}})
        edges.emplace_back(faces[f][static_cast<std::size_t>(a)], faces[f][static_cast<std::size_t>(b)]);
    f = next;
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t e = 0; e < edges.size();) {
    std::size_t next = e + 1;
    while (next < edges.size() && edges[next] == edges[e]) ++next;
    defects += next - e != 2;
    e = next;
  }
  return defects;
}

double add_ventricles(Table& table) {
  const auto domain = ventricles(0.962);  // 1.25 M cells
  const auto materials = materials_of(domain);
  Meshed meshed;
  const double processor = processor_seconds();
  const double time = seconds([&] { meshed = mesh_of(domain, 0, 180, thorough()); });
  const double used = processor_seconds() - processor;
  const auto& c = meshed.complex;
  const auto angles = angles_of_complex(c);
  const auto distances = distances_of(c, materials);
  const auto cells = static_cast<double>(c.cells.size());
  const double exact = volume_of(domain);
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
    if (lattice::is_constrained(seeds.touches[n])) implicit.surface_points_mm.push_back(seeds.nodes_mm[n]);
  adapters::DelaunaySettings settings;
  settings.optimise_seconds = 60;  // perturbation and exudation each: ends before, or is cut off here
  adapters::LabelledCells cells;
  const double time = seconds([&] { cells = adapters::mesh_implicit(implicit, settings); });
  const auto angles = angles_of(cells.nodes_mm, cells.cells, [&](std::size_t i) { return cells.label[i] != 0; });
  const auto count = static_cast<double>(std::count(cells.label.begin(), cells.label.end(), 1));
  const auto add = [&](const char* what, double value, const char* unit, const std::string& note) {
    table.push_back({"mesh-ventricles", fmt::format("CGAL Mesh_3, perturb and exude: {}", what), value, unit, note});
  };
  add("speed", count / time / 1e3, "k cells/s", fmt::format("{:.0f} k cells; its base is not kept flat", count / 1e3));
  add("least dihedral angle", angles.least, "degrees", "");
  add("greatest dihedral angle", angles.greatest, "degrees", "");
  add("our cells per second over its", our_cells_per_second / (count / time), "times", "");
}

void add_random_walls(Table& table) {
  constexpr std::uint32_t domains = 200;
  constexpr double least_deg = 25, greatest_deg = 145;
  int good = 0, again = 0, broken = 0;
  Angles worst;
  for (std::uint32_t seed = 1; seed <= domains; ++seed) {
    const auto meshed = mesh_of(random_walls(seed), least_deg, greatest_deg, {});
    const auto angles = angles_of_complex(meshed.complex);
    good += angles.least >= least_deg && angles.greatest <= greatest_deg;
    again += meshed.tries > 1;
    broken += !(angles.least_volume_mm3 > 0) || defects_of(meshed.complex) > 0;
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
  constexpr int doublings = 8;  // 100 k to 20 M cells
  constexpr double most_bytes_per_cell = 500;
  for (int doubling = 0; doubling < doublings; ++doubling) {
    const double edge = 2.27 * std::exp2(-doubling / 3.0);
    Meshed meshed;
    if (2 * cells_before * most_bytes_per_cell > free_bytes()) {
      table.push_back({"mesh-scaling", fmt::format("{:.0f} k cells: left out", 2 * cells_before / 1e3), 0, "",
                       fmt::format("{:.1f} GB of memory are free", free_bytes() / 1e9)});
      return;
    }
    start_peak();
    const double time = seconds([&] { meshed = mesh_of(ventricles(edge), 0, 180, {}); });
    const double bytes = peak_bytes(), cells = static_cast<double>(meshed.complex.cells.size());
    // Per doubling, whatever the sizes came to.
    const auto per_doubling = [&](double now, double before) {
      return std::pow(now / before, std::numbers::ln2 / std::log(cells / cells_before));
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

}  // namespace heart::benchmarks
