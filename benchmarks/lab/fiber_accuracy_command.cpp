// SPDX-License-Identifier: GPL-3.0-or-later
#include "benchmarks/lab/fiber_accuracy_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "benchmarks/lab/fiber_cases.hpp"
#include "benchmarks/lab/fiber_errors.hpp"
#include "generator/atlas/atlas.hpp"
#include "generator/atlas/atlas_image.hpp"
#include "generator/fibers/frame.hpp"
#include "generator/fibers/high_gradient_cells.hpp"
#include "generator/fibers/registered_pair.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/parallel/threads.hpp"
#include "generator/pipeline/node_walls.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/mathematics.hpp"

namespace heartgen::lab {
namespace {

using Json = nlohmann::json;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

using phantom::HelixField;

Mat3 turned_about(const Vec3& unit, double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180;
  Mat3 rotation;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 column;
    column[axis] = 1;
    const Vec3 along = dot(column, unit) * unit;
    const Vec3 turned = along + math::cos(angle) * (column - along) + math::sin(angle) * cross(unit, column);
    for (int row = 0; row < 3; ++row) rotation[row][axis] = turned[row];
  }
  return rotation;
}

/// What a file of the same heart in another frame or unit would do to its points.
Mat3 file_frame(const std::string& pose) {
  const Mat3 turn = turned_about(normalized({1, -2, 0.5}), 40);
  const Mat3 order{{Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 0, 0}}};
  const auto scaled = [](double factor, Mat3 m) {
    for (auto& row : m.rows) row *= factor;
    return m;
  };
  if (pose == "plain") return {};
  if (pose == "turned") return turn;
  if (pose == "scaled") return scaled(0.8, {});
  if (pose == "axes") return order;
  if (pose == "metres") return scaled(1e-3, {});
  if (pose == "all") return scaled(0.8e-3, order * turn);
  if (pose == "mirrored") return {{Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}};
  throw UserError(fmt::format("\"{}\" is no frame of an atlas", pose), "--atlas-frames",
                  "give plain, turned, scaled, axes, metres, all, mirrored");
}

FiberAtlas atlas_mesh(const std::string& name) {
  if (name != "stand-in") return atlas::read_fiber_atlas(name);
  const auto mesh = phantom::make_standin_atlas();
  return atlas::make_fiber_atlas(name, mesh.nodes_mm, mesh.cells, mesh.node_fibers.fiber);
}

ventricles::AtlasImage atlas_image(const std::string& name, const std::string& frame, double spacing_mm,
                                   HelixField field) {
  if (name == "phantom") return phantom_atlas(spacing_mm, field);
  auto mesh = atlas_mesh(name);
  const Mat3 matrix = file_frame(frame);
  for (Vec3& p : mesh.points_mm) p = matrix * p;
  for (Vec3& f : mesh.fiber) f = matrix * f;
  return atlas::image_of_atlas(atlas::make_fiber_atlas(mesh.name, mesh.points_mm, mesh.cells, mesh.fiber), spacing_mm);
}

KnownAxes known_at_cells(const FiberCase& patient, HelixField field, const TetMesh& mesh) {
  KnownAxes known;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    Vec3 middle;
    for (const auto node : mesh.cells[c]) middle += mesh.nodes_mm[static_cast<std::size_t>(node)] / 4;
    add_known(patient, field, middle, mesh.region[c], c, known);
  }
  return known;
}

/// Between the walls a node counts for the one whose fibre is the known one there: the mesh's and the phantom's idea of
/// where they meet differ by less than a voxel, but their fibres by up to 90 degrees.
KnownAxes known_at_nodes(const FiberCase& patient, HelixField field, const TetMesh& mesh,
                         const std::vector<std::int32_t>& region) {
  KnownAxes known;
  for (std::size_t n = 0; n < region.size(); ++n) {
    if (!is_ventricular(region[n])) continue;
    const auto muscle = tag(phantom::muscle_of_fiber_at(patient.model, mesh.nodes_mm[n]));
    add_known(patient, field, mesh.nodes_mm[n], is_ventricular(muscle) ? muscle : region[n], n, known);
  }
  return known;
}

struct RowName {
  std::string patient, field, frame, method, at;
};

Json row_of(const RowName& name, const Errors& lv, const Errors& rv, double seconds) {
  return {{"case", name.patient},
          {"field", name.field},
          {"atlas_frame", name.frame},
          {"method", name.method},
          {"at", name.at},
          {"lv_places", lv.places},
          {"rv_places", rv.places},
          {"lv_mean_deg", lv.mean_deg},
          {"lv_p95_deg", lv.p95_deg},
          {"lv_cover", lv.cover},
          {"rv_mean_deg", rv.mean_deg},
          {"rv_p95_deg", rv.p95_deg},
          {"rv_cover", rv.cover},
          {"seconds", seconds}};
}

void print_row(const Json& r) {
  const auto value = [&](const char* key) { return r[key].get<double>(); };
  const auto text = [&](const char* key) { return r[key].get<std::string>(); };
  fmt::print("{:8} {:8} {:8} {:12} {:9} {:6.2f} {:6.2f} {:6.0f}   {:6.2f} {:6.2f} {:6.0f}   {:6.1f}\n", text("case"),
             text("field"), text("atlas_frame"), text("method"), text("at"), value("lv_mean_deg"), value("lv_p95_deg"),
             100 * value("lv_cover"), value("rv_mean_deg"), value("rv_p95_deg"), 100 * value("rv_cover"),
             value("seconds"));
  std::fflush(stdout);
}

void check_methods(const std::vector<std::string>& methods) {
  for (const auto& method : methods)
    if (method != "local_angles" && method != "coordinates" && method != "jacobian")
      throw UserError(fmt::format("unknown method \"{}\"", method), "--methods",
                      "use local_angles, coordinates, jacobian");
}

std::vector<HelixField> fields_of(const FiberAccuracyCommand& command) {
  std::vector<HelixField> fields;
  for (const auto& name : command.fields) {
    if (name != "uniform" && name != "regional")
      throw UserError(fmt::format("unknown field \"{}\"", name), "--fields", "use uniform, regional");
    if (name == "regional" && command.atlas != "phantom")
      throw UserError("only the phantom's own heart carries the regional field", "--fields",
                      "leave out --atlas, or ask for uniform");
    fields.push_back(name == "uniform" ? HelixField::uniform : HelixField::regional);
  }
  return fields;
}

void check_frames(const FiberAccuracyCommand& command) {
  for (const auto& frame : command.atlas_frames) {
    file_frame(frame);
    if (frame != "plain" && command.atlas == "phantom")
      throw UserError("the phantom as an atlas is an image in its own frame", "--atlas-frames",
                      "name a mesh with --atlas, for example stand-in");
  }
}

struct Carried {
  fibers::FittedAxes at;
  double seconds = 0;
};

Carried carry_to(const fibers::RegisteredPair& hearts, const std::vector<Vec3>& points_mm, const std::string& method) {
  const double start_s = now_s();
  const auto walls = fibers::point_walls(hearts, points_mm, std::vector<std::uint8_t>(points_mm.size(), 1));
  Carried carried;
  carried.at = fibers::carried_axes(hearts, walls, points_mm, fibers::atlas_positions(hearts, points_mm), method);
  carried.seconds = now_s() - start_s;
  return carried;
}

/// One axis per place of `known`, out of one per voxel, node or cell.
std::vector<AxisTensor> at_sources(const KnownAxes& known, const std::vector<Vec3>& axes) {
  std::vector<AxisTensor> result;
  result.reserve(known.source.size());
  for (const auto source : known.source) result.push_back(axis_tensor(axes[source]));
  return result;
}

/// Rows of one carried heart: at voxels, and at the nodes and cells of a mesh where there is one.
void add_rows(const FiberCase& patient, HelixField field, const fibers::RegisteredPair& hearts, const TetMesh& mesh,
              RowName name, double prepared_s, const std::function<void(Json)>& add) {
  const auto row = [&](const char* at, const KnownAxes& known, const std::vector<AxisTensor>& axes, double seconds) {
    name.at = at;
    add(row_of(name, errors_of(known, axes, true), errors_of(known, axes, false), prepared_s + seconds));
  };
  const auto voxels = known_at_voxels(patient, field);
  const auto at_voxels = carry_to(hearts, voxels.points_mm, name.method);
  row("voxels", voxels, at_voxels.at.axes, at_voxels.seconds);
  if (mesh.cells.empty()) return;
  const auto at_nodes = carry_to(hearts, mesh.nodes_mm, name.method);
  std::vector<Vec3> axes;
  axes.reserve(mesh.nodes_mm.size());
  for (const auto& tensor : at_nodes.at.axes) axes.push_back(leading_axis(tensor));
  const auto node_row = [&](const char* at, const std::vector<std::int32_t>& region) {
    const auto known_nodes = known_at_nodes(patient, field, mesh, region);
    row(at, known_nodes, at_sources(known_nodes, axes), at_nodes.seconds);
  };
  node_row("nodes", pipeline::regions_of_nodes(mesh));
  node_row("own nodes", pipeline::regions_of_own_nodes(mesh));
  const auto is_covered = [&](std::int32_t n) { return trace(at_nodes.at.axes[static_cast<std::size_t>(n)]) > 0; };
  for (std::size_t n = 0; n < axes.size(); ++n)
    if (!is_covered(static_cast<std::int32_t>(n))) axes[n] = {1, 0, 0};
  const auto nodes = fibers::node_frames(axes, std::vector<Vec3>(axes.size(), {0, 0, 1}));
  auto cells = fibers::cell_frames(mesh, nodes);
  fibers::carry_to_steep_cells(hearts, mesh, nodes, at_nodes.at, name.method, cells);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    if (!std::ranges::all_of(mesh.cells[c], is_covered)) cells.fiber[c] = {};
  const auto known_cells = known_at_cells(patient, field, mesh);
  row("cells", known_cells, at_sources(known_cells, cells.fiber), at_nodes.seconds);
}

/// The walls of the exact labels, meshed as a build would; says how many cells they have.
TetMesh mesh_of(const FiberCase& patient, double edge_mm, bool say) {
  if (edge_mm <= 0) return {};
  MeshSettings settings;
  settings.meshes = {"myocardium"};
  settings.heart_edge_mm = edge_mm;
  auto mesh = mesh::mesh_heart(patient.labels, settings).at("myocardium");
  if (say) fmt::print("{}: {} nodes, {} cells\n", patient.name, mesh.nodes_mm.size(), mesh.cells.size());
  return mesh;
}

void check_command(const FiberAccuracyCommand& command) {
  std::ranges::for_each(command.cases, check_fiber_case);
  check_methods(command.methods);
  check_frames(command);
  const auto in_range = [](double mm) { return mm >= 0.5 && mm <= 3; };
  if ((command.spacing_mm.size() != 1 && command.spacing_mm.size() != 3) ||
      !std::all_of(command.spacing_mm.begin(), command.spacing_mm.end(), in_range))
    throw UserError("the spacing of the labels is out of range", "--label-spacing", "give one or three of 0.5 to 3 mm");
  if (command.depth_grid_mm != 0 && !in_range(command.depth_grid_mm))
    throw UserError("the grid's spacing is out of range", "--depth-grid", "give 0.5 to 3 mm");
  if (command.mesh_edge_mm != 0 && !(command.mesh_edge_mm >= 0.5 && command.mesh_edge_mm <= 4))
    throw UserError("the edge length is out of range", "--mesh-edge", "give 0.5 to 4 mm, or 0 for no mesh");
}

}  // namespace

int fiber_accuracy_command(const FiberAccuracyCommand& command) {
  check_command(command);
  const auto fields = fields_of(command);
  FiberSettings settings;
  const Vec3 spacing_mm{command.spacing_mm.front(), command.spacing_mm[command.spacing_mm.size() / 2],
                        command.spacing_mm.back()};
  const double finest_mm = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  settings.depth_grid_mm = command.depth_grid_mm > 0 ? command.depth_grid_mm : finest_mm;
  settings.grid_mm = std::max(settings.grid_mm, settings.depth_grid_mm);
  if (!command.json) fmt::print("{:49} LV mean    p95  cover  RV mean    p95  cover  seconds\n", "axis error, degrees");
  Json rows = Json::array();
  const auto add = [&](const Json& row) {
    rows.push_back(row);
    if (!command.json) print_row(row);
  };
  for (std::size_t f = 0; f < fields.size(); ++f)
    for (const auto& frame : command.atlas_frames) {
      const auto atlas = atlas_image(command.atlas, frame, settings.depth_grid_mm, fields[f]);
      for (const auto& name : command.cases) {
        const FiberCase patient = make_fiber_case(name, spacing_mm);
        const TetMesh mesh = mesh_of(patient, command.mesh_edge_mm, !command.json);
        const double start_s = now_s();
        const auto hearts = fibers::register_pair(patient.labels, patient.landmarks, atlas, command.atlas, settings);
        const double prepared_s = now_s() - start_s;
        for (const auto& method : command.methods)
          add_rows(patient, fields[f], hearts, mesh, {name, command.fields[f], frame, method, ""}, prepared_s, add);
      }
    }
  if (command.json) fmt::print("{}\n", rows.dump(2));
  return 0;
}

}  // namespace heartgen::lab
