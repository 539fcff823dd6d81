// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/transfer_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "exporters/bundle.hpp"
#include "generator/fibers/transfer.hpp"
#include "generator/mesh_files/any_mesh.hpp"
#include "model/bounding_box.hpp"
#include "model/error.hpp"

namespace heartgen::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::array source_names{"without", "atlas", "inpainted", "rule"};

TetMesh read_source(const std::string& path) {
  if (fs::is_directory(path)) return exporters::read_mesh(path, "myocardium");
  auto data = mesh_files::read_any_mesh(path);
  TetMesh mesh;
  mesh.nodes_mm = std::move(data.points);
  mesh.cells = std::move(data.tets);
  for (const auto& [name, field] :
       {std::pair{"fiber", &mesh.node_fibers.fiber}, std::pair{"sheet", &mesh.node_fibers.sheet}}) {
    if (!data.point_vectors.contains(name))
      throw UserError(fmt::format("has no vectors \"{}\" on its points", name), path,
                      "give a bundle, or its meshes/myocardium.vtu");
    *field = std::move(data.point_vectors[name]);
  }
  for (const auto& [name, field] :
       {std::pair{"fiber", &mesh.cell_fibers.fiber}, std::pair{"sheet", &mesh.cell_fibers.sheet}})
    if (const auto found = data.cell_vectors.find(name); found != data.cell_vectors.end())
      *field = std::move(found->second);
  const auto source = data.point_scalars.find("fiber_source");
  if (source == data.point_scalars.end()) return mesh;
  for (const double value : source->second)
    if (!(value >= 0 && value < static_cast<double>(source_names.size())) || value != std::round(value))
      throw UserError(fmt::format("\"fiber_source\" is {:g} somewhere", value), path, "its values are 0 to 3");
  mesh.fiber_source.assign(source->second.begin(), source->second.end());
  return mesh;
}

void check(const TransferCommand& command) {
  if (!(command.search_mm > 0) || !std::isfinite(command.search_mm))
    throw UserError("must be a positive number", "--reach", "give mm");
  mesh_files::check_mesh_output(command.output);
}

std::string size_text(const std::vector<Vec3>& points) {
  const auto [low, high] = bounding_box(points);
  return fmt::format("{:.4g} x {:.4g} x {:.4g}", high.x - low.x, high.y - low.y, high.z - low.z);
}

void refuse_wrong_unit(const TetMesh& source, const std::vector<Vec3>& points, const TransferCommand& command) {
  const auto factor = fibers::scale_onto(source, points, command.search_mm);
  if (!factor) return;
  const char* unit = *factor == 10 ? "cm" : *factor == 1000 ? "m" : *factor == 0.001 ? "um" : "tenths of mm";
  throw UserError(fmt::format("is {} where {} is {} mm, and lies on it when scaled by {:g}", size_text(points),
                              command.source, size_text(source.nodes_mm), *factor),
                  command.input, fmt::format("is it in {}? scale it by {:g}", unit, *factor));
}

void refuse_far_nodes(const fibers::TransferredFibers& result, std::size_t nodes, const TransferCommand& command) {
  const auto beyond = static_cast<std::size_t>(result.beyond_nodes);
  if (beyond == nodes || (beyond > 0 && !command.partial))
    throw UserError(fmt::format("{} of {} nodes lie farther than {:g} mm from {}, up to {:.4g} mm", beyond, nodes,
                                command.search_mm, command.source, result.farthest_mm),
                    command.input,
                    beyond == nodes ? "is it the same heart, in mm and in the same frame?"
                                    : "allow more with --reach, or leave them without fibres with --partial");
}

void store(UnstructuredData& mesh, fibers::TransferredFibers& result) {
  const auto put = [](auto& vectors, FiberField& field) {
    vectors["fiber"] = std::move(field.fiber);
    vectors["sheet"] = std::move(field.sheet);
    vectors["sheet_normal"] = std::move(field.sheet_normal);
  };
  put(mesh.point_vectors, result.node);
  put(mesh.cell_vectors, result.cell);
  mesh.point_scalars.erase("fiber_source");  // of other fibres
  mesh.integers.insert("fiber_source");
  if (!result.source.empty()) mesh.point_scalars["fiber_source"] = {result.source.begin(), result.source.end()};
}

void print(const TransferCommand& command, const UnstructuredData& mesh, const fibers::TransferredFibers& result) {
  Json sources = Json::object();
  for (std::size_t s = 0; s < source_names.size() && !result.source.empty(); ++s)
    sources[source_names[s]] = std::count(result.source.begin(), result.source.end(), s);
  if (command.json) {
    fmt::print("{}\n", Json{{"output", command.output},
                            {"nodes", mesh.points.size()},
                            {"cells", mesh.tets.size()},
                            {"nodes_beyond_reach", result.beyond_nodes},
                            {"farthest_mm", result.farthest_mm},
                            {"nodes_by_source", sources},
                            {"remarks", mesh.remarks}}
                           .dump(1));
    return;
  }
  fmt::print("{}: fibres on {} nodes and {} cells\n", command.output, mesh.points.size(), mesh.tets.size());
  fmt::print("farthest node from the source: {:.3g} mm; {} beyond {:g} mm are without fibres\n", result.farthest_mm,
             result.beyond_nodes, command.search_mm);
  for (const auto& remark : mesh.remarks) fmt::print("{}\n", remark);
}

}  // namespace

int transfer_command(const TransferCommand& command) {
  check(command);
  const TetMesh source = read_source(command.source);
  auto mesh = mesh_files::read_any_mesh(command.input);
  refuse_wrong_unit(source, mesh.points, command);
  auto result = fibers::transfer_fibers(source, mesh.points, mesh.tets, command.search_mm);
  refuse_far_nodes(result, mesh.points.size(), command);
  store(mesh, result);
  const auto labels = mesh_files::find_labels(mesh, "", command.input);
  for (auto& remark : mesh_files::write_any_mesh(command.output, mesh, labels))
    mesh.remarks.push_back(std::move(remark));
  print(command, mesh, result);
  return 0;
}

}  // namespace heartgen::app
