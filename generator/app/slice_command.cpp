// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/slice_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "exporters/tri_mesh.hpp"
#include "generator/mesh/slice_mesh.hpp"
#include "generator/pipeline/stage_files.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heartgen::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int validation_failed = 3;

std::int64_t chosen_slice(const SliceCommand& command, const Grid& grid) {
  if (command.index.has_value() == command.z_mm.has_value())
    throw UserError("which slice?", "slice", "give either --index or --z");
  return command.index ? *command.index : mesh::slice_at_height(grid, *command.z_mm);
}

/// An edge as long as the image gives one or two triangles and no slice of a thorax.
void refuse_longer_than(const Grid& grid, const char* option, double edge_mm) {
  const double min_mm = std::min(static_cast<double>(grid.size[0]) * grid.spacing_mm.x,
                                 static_cast<double>(grid.size[1]) * grid.spacing_mm.y);
  if (edge_mm > min_mm)
    throw UserError(fmt::format("an edge of {:g} mm in an image of {:g} mm", edge_mm, min_mm),
                    fmt::format("slice {}", option), "give a length of some millimetres");
}

Json numbers_of(const SliceCommand& command, const TriMesh& mesh, const mesh::SliceReport& report) {
  return {{"file", command.output},
          {"nodes", mesh.nodes_mm.size()},
          {"triangles", mesh.triangles.size()},
          {"edges", mesh.edges.size()},
          {"least_angle_deg", report.min_angle_deg},
          {"greatest_angle_deg", report.greatest_angle_deg},
          {"triangles_outside_28_120_deg", report.outside_bounds},
          {"curve_distance_p99_edges", report.distance_p99},
          {"curve_distance_max_edges", report.distance_max},
          {"area_mm2", report.area_mm2},
          {"area_inside_curves_mm2", report.curve_area_mm2},
          {"seconds_truss", report.seconds_truss},
          {"seconds_improve", report.seconds_improve}};
}

void print_numbers(const SliceCommand& command, const TriMesh& mesh, const mesh::SliceReport& report) {
  fmt::print("{}: {} nodes, {} triangles, {} labelled edges\n", command.output, mesh.nodes_mm.size(),
             mesh.triangles.size(), mesh.edges.size());
  fmt::print("angles from {:.2f} to {:.2f} degrees, {} triangles outside [28, 120]\n", report.min_angle_deg,
             report.greatest_angle_deg, report.outside_bounds);
  fmt::print("interface edges to their curve: p99 {:.3f}, max {:.3f} of the edge\n", report.distance_p99,
             report.distance_max);
  for (const auto& [name, area] : report.area_mm2) {
    const auto found = report.curve_area_mm2.find(name);
    const double inside = found == report.curve_area_mm2.end() ? 0 : found->second;
    fmt::print("  {:<15} {:10.1f} mm2 ({:+.2f} % of its curves')\n", name, area,
               inside > 0 ? 100 * (area / inside - 1) : 0.0);
  }
  fmt::print("{:.2f} s truss, {:.2f} s improvement\n", report.seconds_truss, report.seconds_improve);
}

}  // namespace

int slice_command(const SliceCommand& command) {
  const auto input =
      fs::is_directory(command.input) ? fs::path(command.input) / "images" / "labels.nii.gz" : fs::path(command.input);
  const auto extension = fs::path(command.output).extension();
  if (extension != ".vtu" && extension != ".msh")
    throw UserError("unknown kind of mesh file", command.output, "give a name that ends in .vtu or .msh");
  check_output(command.output);
  const auto labels = pipeline::read_region_labels(input.string());
  mesh::SliceSettings settings;
  settings.edge_mm = command.edge_mm.value_or(settings.edge_mm);
  settings.torso_edge_mm = command.torso_edge_mm.value_or(std::max(settings.torso_edge_mm, settings.edge_mm));
  settings.growth = command.growth.value_or(settings.growth);
  refuse_longer_than(labels.grid, "--edge", settings.edge_mm);
  refuse_longer_than(labels.grid, "--torso-edge", command.torso_edge_mm.value_or(0));
  mesh::SliceReport report;
  const auto mesh = mesh::mesh_slice(labels, chosen_slice(command, labels.grid), settings, &report);
  exporters::write_tri_mesh(command.output, mesh);
  if (command.json)
    fmt::print("{}\n", numbers_of(command, mesh, report).dump(1));
  else
    print_numbers(command, mesh, report);
  return report.outside_bounds == 0 ? 0 : validation_failed;
}

}  // namespace heartgen::app
