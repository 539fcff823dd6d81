// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/improve_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "generator/mesh_files/any_mesh.hpp"
#include "generator/tetmesh/carry_mesh.hpp"
#include "generator/tetmesh/orient.hpp"
#include "model/error.hpp"
#include "validation/cell_quality.hpp"

namespace heartgen::app {
namespace {

using Json = nlohmann::ordered_json;

/// All names that are not there are told at once.
void drop_arrays(UnstructuredData& mesh, const ImproveCommand& command) {
  std::vector<std::string> missing;
  for (const auto& name : command.drop) {
    std::size_t dropped = 0;
    const auto drop = [&](auto&... arrays) { ((dropped += arrays.erase(name)), ...); };
    drop(mesh.point_scalars, mesh.point_vectors, mesh.point_tensors, mesh.cell_scalars, mesh.cell_vectors,
         mesh.cell_tensors, mesh.face_scalars, mesh.face_vectors, mesh.face_tensors);
    if (dropped == 0) missing.push_back(name);
  }
  if (!missing.empty())
    throw UserError(fmt::format("has no array \"{}\"", fmt::join(missing, "\", \"")), command.input, "correct --drop");
}

// ---- what is printed ----

constexpr std::size_t bin_count = 14;
constexpr double bin_deg = 5;

struct Angles {
  std::size_t nodes = 0, cells = 0;
  std::int64_t inverted = 0;
  double min_deg = 180, max_deg = 0;
  std::array<std::int64_t, bin_count> cells_by_min{};  ///< smallest dihedral angle, in steps of 5 degrees
};

Angles measure(const std::vector<Vec3>& nodes, const std::vector<Cell>& cells) {
  Angles angles{nodes.size(), cells.size()};
  for (const auto& cell : cells) {
    std::array<Vec3, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = nodes[static_cast<std::size_t>(cell[i])];
    const auto q = validation::cell_quality(corners);
    angles.inverted += !(q.volume_mm3 > 0);
    angles.min_deg = std::min(angles.min_deg, q.min_dihedral_deg);
    angles.max_deg = std::max(angles.max_deg, q.max_dihedral_deg);
    ++angles.cells_by_min[std::min(static_cast<std::size_t>(q.min_dihedral_deg / bin_deg), bin_count - 1)];
  }
  return angles;
}

Json as_json(const Angles& a) {
  return {{"nodes", a.nodes},
          {"cells", a.cells},
          {"inverted_cells", a.inverted},
          {"dihedral_min_deg", a.min_deg},
          {"dihedral_max_deg", a.max_deg},
          {"cells_by_smallest_angle_in_steps_of_5_deg", a.cells_by_min}};
}

void print(const Angles& before, const Angles& after) {
  fmt::print("{:<28} {:>12} {:>12}\n", "", "before", "after");
  const auto row = [](const char* name, const auto& a, const auto& b) {
    fmt::print("{:<28} {:>12} {:>12}\n", name, a, b);
  };
  row("nodes", before.nodes, after.nodes);
  row("cells", before.cells, after.cells);
  row("inverted cells", before.inverted, after.inverted);
  row("smallest dihedral angle", fmt::format("{:.3f}", before.min_deg), fmt::format("{:.3f}", after.min_deg));
  row("largest dihedral angle", fmt::format("{:.3f}", before.max_deg), fmt::format("{:.3f}", after.max_deg));
  fmt::print("cells by smallest angle:\n");
  for (std::size_t bin = 0; bin < bin_count; ++bin)
    row(fmt::format("  {:>2.0f} to {:>2.0f} degrees", bin_deg * static_cast<double>(bin),
                    bin_deg * static_cast<double>(bin + 1))
            .c_str(),
        before.cells_by_min[bin], after.cells_by_min[bin]);
}

Json as_json(const ImproveCommand& command, const Angles& before, const Angles& after,
             const tetmesh::ImprovedMesh& improved, const std::vector<std::string>& remarks) {
  return {{"output", command.output},
          {"before", as_json(before)},
          {"after", as_json(after)},
          {"cells_below_goal", improved.cells_below_goal},
          {"surfaces_unchanged", improved.is_fixed},
          {"surface_distance_max", improved.drift_mm},
          {"remarks", remarks}};
}

}  // namespace

int improve_command(const ImproveCommand& command) {
  if (!mesh_files::is_mesh_name(command.input)) mesh_files::read_any_mesh(command.input);  // tells the kinds there are
  mesh_files::check_mesh_output(command.output);
  auto mesh = mesh_files::read_any_mesh(command.input);
  drop_arrays(mesh, command);
  const auto labels = mesh_files::find_labels(mesh, command.region, command.input);
  const auto ids = tetmesh::take_out_ids(mesh, labels);
  const auto improved =
      tetmesh::improve_mesh(mesh.points, mesh.tets, mesh_files::cell_labels(mesh, labels), command.settings);
  const auto before = measure(mesh.points, tetmesh::oriented_cells(mesh.points, mesh.tets));
  const auto after = measure(improved.nodes_mm, improved.cells);
  const auto result = tetmesh::carried_mesh(mesh, labels, ids, improved);
  auto remarks = result.remarks;
  for (auto& remark : mesh_files::write_any_mesh(command.output, result, labels)) remarks.push_back(std::move(remark));
  if (command.json) {
    fmt::print("{}\n", as_json(command, before, after, improved, remarks).dump(1));
    return 0;
  }
  print(before, after);
  fmt::print("{} cells stay below the goal of {:g} degrees\n", improved.cells_below_goal, command.settings.goal_deg);
  if (improved.is_fixed)
    fmt::print("surfaces, interfaces and their faces: unchanged\n");
  else
    fmt::print("surfaces and interfaces: within {:.3g} of the given ones\n", improved.drift_mm);
  for (const auto& remark : remarks) fmt::print("{}\n", remark);
  fmt::print("{}\n", command.output);
  return 0;
}

}  // namespace heartgen::app
