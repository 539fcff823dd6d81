// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/cgal_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "benchmarks/mesh_measures.hpp"

namespace heartgen::benchmarks {

void add_cgal_rows(Table& table, const char* bench, const adapters::ImplicitDomain& domain, const std::string& note,
                   double our_cells_per_second) {
  adapters::DelaunaySettings settings;
  settings.optimise_seconds = 60;  // perturbation and exudation each: ends before, or is cut off here
  LabelledCells cells;
  const double time = seconds([&] { cells = adapters::mesh_implicit(domain, settings); });
  const auto angles = angles_of(cells.nodes_mm, cells.cells, [&](std::size_t i) { return cells.label[i] != 0; });
  const auto count = static_cast<double>(
      cells.label.size() - static_cast<std::size_t>(std::count(cells.label.begin(), cells.label.end(), 0)));
  const auto add = [&](const char* what, double value, const char* unit, const std::string& remark) {
    table.push_back({bench, fmt::format("CGAL Mesh_3, perturb and exude: {}", what), value, unit, remark});
  };
  add("speed", count / time / 1e3, "k cells/s", fmt::format("{:.0f} k cells; {}", count / 1e3, note));
  add("least dihedral angle", angles.least, "degrees", "");
  add("greatest dihedral angle", angles.greatest, "degrees", "");
  add("our cells per second over its", our_cells_per_second / (count / time), "times", "");
}

}  // namespace heartgen::benchmarks
