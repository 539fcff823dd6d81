// SPDX-License-Identifier: GPL-3.0-or-later
// The back ends of the mesher on one label map, measured by the certificate, which knows nothing of them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "benchmarks/benchmarks.hpp"
#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/mesh/domain.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/parallel/threads.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "validation/curve_fidelity.hpp"
#include "validation/label_fidelity.hpp"
#include "validation/mesh_checks.hpp"

namespace heartgen::benchmarks {
namespace {

constexpr const char* bench = "mesh-backends";

bool is_heart(std::uint8_t label) {
  return is_myocardium(static_cast<Region>(label)) || is_blood(static_cast<Region>(label));
}

LabelVolume heart_of(const Settings& settings) {
  LabelVolume labels;
  if (settings.labels.empty()) {
    phantom::PhantomSettings phantom;
    phantom.variant = settings.variant;
    phantom.companions = phantom.fibers = false;
    labels = phantom::make_phantom(phantom).labels;
  } else {
    labels = adapters::read_labels(settings.labels);
  }
  for (auto& label : labels.voxels) label = is_heart(label) ? label : std::uint8_t{0};
  return labels;
}

/// The rows of a bundle's certificate, with the bounds that a recipe has by default.
Report certificate_of(const TetMesh& mesh, const LabelVolume& labels, const MeshSettings& settings) {
  const auto domain = mesh::make_domain(labels, settings);
  const auto label_at = [&domain](const Vec3& p) -> int {
    return mesh::region_at(domain, index_from_lps(domain.grid, p));
  };
  const auto faces = validation::mesh_faces(mesh);
  auto rows = validation::check_mesh("heart", mesh, faces, {});
  for (const auto& more : {validation::check_against_labels("heart", mesh, faces, labels, {}),
                           validation::check_against_level_sets("heart", mesh, faces, labels.grid, label_at, {}),
                           validation::check_curves("heart", mesh, faces, labels, label_at)})
    rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

double value_of(const Report& rows, const std::string& metric) {
  const auto row =
      std::ranges::find_if(rows, [&](const ReportRow& r) { return r.scope == "heart" && r.metric == metric; });
  return row == rows.end() ? 0 : row->value;
}

/// Greatest change of a region's volume, of those with a volume of at least a millilitre.
ReportRow worst_volume(const Report& rows) {
  ReportRow worst;
  for (const auto& row : rows) {
    const auto is_large = std::ranges::any_of(rows, [&](const ReportRow& other) {
      return other.scope == row.scope && other.metric == "volume_of_labels" && other.value >= 1;
    });
    if (row.metric == "volume_difference" && is_large && std::abs(row.value) > std::abs(worst.value)) worst = row;
  }
  return worst;
}

void add_backend(Table& table, const char* backend, const LabelVolume& labels) {
  MeshSettings settings;
  settings.heart_edge_mm = settings.blood_edge_mm = 3;
  settings.backend = backend;
  const auto add = [&](const char* what, double value, const char* unit, const std::string& note) {
    table.push_back({bench, fmt::format("{}: {}", backend, what), value, unit, note});
  };
  TetMesh mesh;
  double time = 0;
  try {
    time = seconds([&] { mesh = mesh::mesh_labels(labels, settings); });
  } catch (const UserError& error) {
    add("refused", 0, "", error.what());
    return;
  }
  const auto rows = certificate_of(mesh, labels, settings);
  const auto cells = static_cast<double>(mesh.cells.size());
  std::vector<std::string> red;
  for (const auto& row : rows)
    if (!row.passed()) red.push_back(fmt::format("{} {:.4g}", row.metric, row.value));
  const auto volume = worst_volume(rows);
  add("cells", cells / 1e3, "k", "");
  add("from label map to labelled mesh", time, "s", fmt::format("{:.0f} k cells/s", cells / time / 1e3));
  add("least dihedral angle", value_of(rows, "dihedral_min"), "degrees", "");
  add("greatest dihedral angle", value_of(rows, "dihedral_max"), "degrees", "");
  add("surfaces to its level sets, p99", value_of(rows, "to_level_set_p99_in_edges"), "edges", "");
  add("level sets to its surfaces, p99", value_of(rows, "from_level_set_p99_in_edges"), "edges", "");
  add("curves to the level sets', p99", value_of(rows, "curve_to_level_set_p99_in_edges"), "edges",
      "where three regions meet");
  add("worst volume of a region", volume.value, "%", volume.scope);
  add("red rows of the certificate", static_cast<double>(red.size()), "", fmt::format("{}", fmt::join(red, ", ")));
}

}  // namespace

Table bench_mesh_backends(const Settings& settings, const parallel::Comm& comm) {
  Table table;
  if (!comm.is_root()) return table;
  parallel::set_thread_count(1);  // as many as all of them can use
  const auto labels = heart_of(settings);
  for (const char* backend : {"lattice", "distmesh", "cgal", "tetgen"}) add_backend(table, backend, labels);
  parallel::set_thread_count(settings.threads);
  return table;
}

}  // namespace heartgen::benchmarks
