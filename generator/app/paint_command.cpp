// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/app/paint_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "generator/mesh_files/any_mesh.hpp"
#include "generator/painting/paint.hpp"
#include "generator/tetmesh/orient.hpp"
#include "model/bounding_box.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen::app {
namespace {

using Json = nlohmann::ordered_json;

/// What the painting needs of a mesh from elsewhere.
TetMesh painted_part(const UnstructuredData& data, const std::string& labels) {
  TetMesh mesh;
  mesh.nodes_mm = data.points;
  mesh.cells = tetmesh::oriented_cells(data.points, data.tets);
  mesh.region =
      labels.empty() ? std::vector<std::int32_t>(mesh.cells.size(), 1) : mesh_files::cell_labels(data, labels);
  return mesh;
}

std::string name_of(const UnstructuredData& data, std::int32_t tag) {
  const auto found = data.names.find({3, tag});
  return found == data.names.end() ? region_name(tag) : found->second;
}

/// Tags of --only; all without it.
std::set<std::int32_t> painted_tags(const PaintCommand& command, const UnstructuredData& data, const TetMesh& mesh) {
  const std::set<std::int32_t> held(mesh.region.begin(), mesh.region.end());
  if (command.only.empty()) return held;
  std::set<std::int32_t> tags;
  for (const auto& wanted : command.only) {
    const auto found = std::find_if(held.begin(), held.end(), [&](std::int32_t tag) {
      return wanted == std::to_string(tag) || wanted == name_of(data, tag);
    });
    if (found == held.end()) {
      std::vector<std::string> known;
      for (const auto tag : held) known.push_back(name_of(data, tag));
      throw UserError(fmt::format("has no region \"{}\"", wanted), command.input,
                      fmt::format("its regions: {}", fmt::join(known, ", ")));
    }
    tags.insert(*found);
  }
  return tags;
}

/// The nodes' box stands for the mesh: whether a region lies in a cell shows when it is painted.
painting::Target box_of(const UnstructuredData& data) {
  const auto [low, high] = bounding_box(data.points);
  return {"the mesh",
          [low = low, high = high](const Vec3& p) {
            return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
          },
          low, high};
}

void refuse_unpainted(const TetMesh& mesh, const std::vector<painting::RegionMask>& regions) {
  for (std::size_t r = 0; r < regions.size(); ++r)
    if (painting::volume_mm3(mesh, mesh.user_regions[r]) == 0)
      throw UserError(fmt::format("the region \"{}\" lies in no cell that is painted", regions[r].name),
                      regions[r].file, "give one of the same patient, in the same frame (LPS, mm); or another --only");
}

void store(UnstructuredData& data, const TetMesh& mesh) {
  data.integers.insert("user_region");
  data.cell_scalars["user_region"] = {mesh.user_region.begin(), mesh.user_region.end()};
  for (const auto& region : mesh.user_regions)
    data.cell_scalars["fraction_" + region.name] = {region.fraction.begin(), region.fraction.end()};
}

void print(const PaintCommand& command, const TetMesh& mesh, const std::vector<painting::RegionMask>& regions,
           const std::vector<std::string>& remarks) {
  constexpr double mm3_per_ml = 1000;
  Json rows = Json::array();
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const auto& region = mesh.user_regions[r];
    const double given = painting::volume_mm3(regions[r].mask), held = painting::volume_mm3(mesh, region);
    const auto cells = std::count(mesh.user_region.begin(), mesh.user_region.end(), region.tag);
    rows.push_back({{"name", region.name},
                    {"tag", region.tag},
                    {"cells", cells},
                    {"volume_ml", held / mm3_per_ml},
                    {"outside_share", std::max(0.0, 1 - held / given)}});
    if (!command.json)
      fmt::print("{}: tag {}, {} cells, {:.3g} ml; {:.0f} % of the region lies outside\n", region.name, region.tag,
                 cells, held / mm3_per_ml, 100 * std::max(0.0, 1 - held / given));
  }
  if (command.json)
    fmt::print("{}\n", Json{{"output", command.output}, {"regions", rows}, {"remarks", remarks}}.dump(1));
  else
    for (const auto& remark : remarks) fmt::print("{}\n", remark);
}

}  // namespace

int paint_command(const PaintCommand& command) {
  mesh_files::check_mesh_output(command.output);
  std::vector<RegionSettings> files;
  for (const auto& text : command.regions) files.push_back(painting::region_argument(text));
  const auto regions = painting::read_regions(files);
  auto data = mesh_files::read_any_mesh(command.input);
  const auto labels = mesh_files::find_labels(data, command.region, command.input);
  TetMesh mesh = painted_part(data, labels);
  const auto tags = painted_tags(command, data, mesh);
  painting::refuse_regions_elsewhere(regions, box_of(data));
  painting::paint(mesh, regions, [&](std::int32_t tag) { return tags.contains(tag); });
  refuse_unpainted(mesh, regions);
  store(data, mesh);
  auto remarks = data.remarks;
  for (auto& remark : mesh_files::write_any_mesh(command.output, data, labels)) remarks.push_back(std::move(remark));
  print(command, mesh, regions, remarks);
  return 0;
}

}  // namespace heartgen::app
