// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "exporters/bundle.hpp"
#include "exporters/cut.hpp"
#include "exporters/registry.hpp"
#include "generator/app/commands.hpp"
#include "generator/app/own_mesh.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen::app {
namespace {

namespace fs = std::filesystem;
using exporters::Manifest;

struct NamedMesh {
  std::string name;
  TetMesh mesh;
};

std::vector<std::string> mesh_names(const Manifest& manifest) {
  std::vector<std::string> names;
  for (const auto& [name, entry] : manifest.meshes) names.push_back(name);
  return names;
}

/// The mesh to cut regions out of: that which holds most of them; of equal ones the walls before all else.
std::string mesh_with(const Manifest& manifest, const std::set<std::int32_t>& regions) {
  auto names = mesh_names(manifest);
  std::stable_partition(names.begin(), names.end(), [](const auto& name) { return name == "myocardium"; });
  const auto held = [&](const std::string& name) {
    return std::count_if(regions.begin(), regions.end(),
                         [&](std::int32_t tag) { return manifest.meshes.at(name).regions.contains(region_name(tag)); });
  };
  return *std::max_element(names.begin(), names.end(), [&](const auto& a, const auto& b) { return held(a) < held(b); });
}

void require_mesh(const Manifest& manifest, const ExportCommand& command) {
  if (command.mesh.empty() || manifest.meshes.contains(command.mesh)) return;
  throw UserError(fmt::format("has no mesh \"{}\"", command.mesh), command.bundle,
                  fmt::format("its meshes: {}", fmt::join(mesh_names(manifest), ", ")));
}

void require_regions(const Manifest& manifest, const ExportCommand& command, const std::string& mesh) {
  const auto& held = manifest.meshes.at(mesh).regions;
  std::vector<std::string> known;
  for (const auto& [region, cells] : held) known.push_back(region);
  for (const auto& name : command.only) {
    const auto tags = exporters::regions_named(std::span(&name, 1));
    if (std::none_of(tags.begin(), tags.end(), [&](std::int32_t tag) { return held.contains(region_name(tag)); }))
      throw UserError(fmt::format("mesh \"{}\" has no {}", mesh, name), command.bundle,
                      fmt::format("its regions: {}", fmt::join(known, ", ")));
  }
}

/// Names of the bundle's meshes to export.
std::vector<std::string> meshes_to_export(const Manifest& manifest, const ExportCommand& command) {
  require_mesh(manifest, command);
  if (command.only.empty()) return command.mesh.empty() ? mesh_names(manifest) : std::vector{command.mesh};
  const auto regions = exporters::regions_named(command.only);
  const std::string mesh = command.mesh.empty() ? mesh_with(manifest, regions) : command.mesh;
  require_regions(manifest, command, mesh);
  return {mesh};
}

NamedMesh read_to_export(const ExportCommand& command, const std::string& name) {
  NamedMesh result{name, exporters::read_mesh(command.bundle, name)};
  if (!command.only.empty()) {
    result.mesh = exporters::only_regions(result.mesh, exporters::regions_named(command.only));
    result.name += fmt::format("_{}", fmt::join(command.only, "_"));
  }
  if (command.no_interfaces) result.mesh = exporters::without_interfaces(std::move(result.mesh));
  return result;
}

}  // namespace

int export_command(const ExportCommand& command) {
  if (is_own_mesh(command.bundle)) return export_own_mesh(command);
  const auto manifest = exporters::read_manifest(command.bundle);
  const auto sources = meshes_to_export(manifest, command);
  for (const auto& format : command.formats) exporters::find_format(format);  // before anything is written
  exporters::refuse_inside(command.output, command.bundle);
  auto files = nlohmann::ordered_json::array();
  for (const auto& source : sources) {
    const auto [name, mesh] = read_to_export(command, source);
    for (const auto& format : command.formats)
      for (const auto& file :
           exporters::export_mesh(format, mesh, name, fs::path(command.output) / format, command.unit)) {
        files.push_back(file.string());
        if (!command.json) fmt::print("{}\n", file.string());
      }
  }
  if (command.json) fmt::print("{}\n", files.dump(1));
  return 0;
}

}  // namespace heartgen::app
