#include "generator/app/transfer_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "exporters/bundle.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "generator/fibers/transfer.hpp"
#include "model/error.hpp"
#include "model/text.hpp"

namespace heart::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::array source_names{"without", "atlas", "inpainted", "rule"};

TetMesh read_source(const std::string& path) {
  if (fs::is_directory(path)) return exporters::read_mesh(path, "myocardium");
  auto data = adapters::read_unstructured(path);
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
  if (!(command.reach_mm > 0) || !std::isfinite(command.reach_mm))
    throw UserError("must be a positive number", "--reach", "give mm");
  const auto extension = fs::path(command.output).extension();
  if (extension != ".vtu" && extension != ".vtk")
    throw UserError("is of no known kind", command.output, "use .vtu or .vtk");
  check_output(command.output);
}

void refuse_far_nodes(const fibers::TransferredFibers& result, std::size_t nodes, const TransferCommand& command) {
  const auto beyond = static_cast<std::size_t>(result.beyond_nodes);
  if (beyond == nodes || (beyond > 0 && !command.partial))
    throw UserError(fmt::format("{} of {} nodes lie farther than {:g} mm from {}, up to {:.4g} mm", beyond, nodes,
                                command.reach_mm, command.source, result.farthest_mm),
                    command.input,
                    beyond == nodes ? "is it the same heart, in mm and in the same frame?"
                                    : "allow more with --reach, or leave them without fibres with --partial");
}

void store(adapters::UnstructuredData& mesh, fibers::TransferredFibers& result) {
  const auto put = [](auto& vectors, FiberField& field) {
    vectors["fiber"] = std::move(field.fiber);
    vectors["sheet"] = std::move(field.sheet);
    vectors["sheet_normal"] = std::move(field.sheet_normal);
  };
  put(mesh.point_vectors, result.node);
  put(mesh.cell_vectors, result.cell);
  mesh.point_scalars.erase("fiber_source");  // of other fibres
  if (!result.source.empty()) mesh.point_scalars["fiber_source"] = {result.source.begin(), result.source.end()};
}

void print(const TransferCommand& command, const adapters::UnstructuredData& mesh,
           const fibers::TransferredFibers& result) {
  Json sources = Json::object();
  for (std::size_t s = 0; s < source_names.size() && !result.source.empty(); ++s)
    sources[source_names[s]] = std::count(result.source.begin(), result.source.end(), s);
  if (command.json) {
    fmt::print("{}\n", Json{{"output", command.output},
                            {"nodes", mesh.points.size()},
                            {"cells", mesh.tets.size()},
                            {"nodes_beyond_reach", result.beyond_nodes},
                            {"farthest_mm", result.farthest_mm},
                            {"nodes_by_source", sources}}
                           .dump(1));
    return;
  }
  fmt::print("{}: fibres on {} nodes and {} cells\n", command.output, mesh.points.size(), mesh.tets.size());
  fmt::print("farthest node from the source: {:.3g} mm; {} beyond {:g} mm are without fibres\n", result.farthest_mm,
             result.beyond_nodes, command.reach_mm);
}

}  // namespace

int transfer_command(const TransferCommand& command) {
  check(command);
  const TetMesh source = read_source(command.source);
  auto mesh = adapters::read_unstructured(command.input);
  auto result = fibers::transfer_fibers(source, mesh.points, mesh.tets, command.reach_mm);
  refuse_far_nodes(result, mesh.points.size(), command);
  store(mesh, result);
  adapters::write_unstructured(command.output, mesh);
  print(command, mesh, result);
  return 0;
}

}  // namespace heart::app
