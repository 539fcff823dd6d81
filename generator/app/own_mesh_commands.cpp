// SPDX-License-Identifier: GPL-3.0-or-later
// `validate` and `export` of a mesh of the user's own.
#include <fmt/format.h>

#include <filesystem>
#include <heartgen/checks.hpp>
#include <heartgen/meshes.hpp>
#include <nlohmann/json.hpp>

#include "exporters/certificate_json.hpp"
#include "exporters/cut.hpp"
#include "exporters/registry.hpp"
#include "generator/app/own_mesh.hpp"
#include "generator/mesh_files/any_mesh.hpp"
#include "generator/pipeline/print_certificate.hpp"
#include "model/error.hpp"

namespace heartgen::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int validation_failed = 3;

}  // namespace

bool is_own_mesh(const std::string& path) { return mesh_files::is_mesh_name(path) && !fs::is_directory(path); }

int validate_own_mesh(const ValidateCommand& command) {
  if (!command.reference_labels.empty() || !command.reference_fibers.empty())
    throw UserError("is compared with bundles only", "--reference-labels, --reference-fibers", "give a bundle");
  const auto own = read_mesh(command.bundle, command.region, command.input_unit);
  const Report report = check_mesh(own);
  if (command.json) {
    fmt::print("{}\n", exporters::certificate_json({report, {}, {}}));
  } else {
    pipeline::print_rows(report, command.all_rows);
    for (const auto& remark : own.remarks) fmt::print("{}\n", remark);
  }
  return all_passed(report) ? 0 : validation_failed;
}

int export_own_mesh(const ExportCommand& command) {
  if (!command.mesh.empty())
    throw UserError("names a mesh of a bundle", "--mesh " + command.mesh, "leave it out: the file has one mesh");
  for (const auto& format : command.formats) exporters::find_format(format);  // before anything is written
  if (!command.only.empty())
    throw UserError("cuts regions out of a bundle's mesh", "--only",
                    "leave it out: a mesh of your own is exported whole");
  auto own = read_mesh(command.bundle, command.region, command.input_unit);
  if (command.no_interfaces) own.mesh = exporters::without_interfaces(std::move(own.mesh));
  Json files = Json::array();
  for (const auto& format : command.formats)
    for (const auto& file :
         exporters::export_mesh(format, own.mesh, own.name, fs::path(command.output) / format, command.unit)) {
      files.push_back(file.string());
      if (!command.json) fmt::print("{}\n", file.string());
    }
  if (command.json) fmt::print("{}\n", files.dump(1));
  for (const auto& remark : own.remarks) fmt::print(stderr, "{}\n", remark);
  return 0;
}

}  // namespace heartgen::app
