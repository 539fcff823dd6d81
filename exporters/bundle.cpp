// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/bundle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "exporters/bundle_texts.hpp"
#include "exporters/certificate_json.hpp"
#include "exporters/files.hpp"
#include "exporters/manifest.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/adapters/vtk_io.hpp"
#include "generator/parallel/tasks.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/mesh_queries/feature_curves.hpp"
#include "model/parent_fibers.hpp"
#include "model/text.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t rim_tag_base = 1000;

/// Compression takes most of the time: on all threads, the largest files first.
void write_meshes(const Bundle& bundle, const Manifest& manifest, const fs::path& folder) {
  std::vector<std::pair<std::size_t, std::function<void()>>> files;
  for (const auto& [name, named] : bundle.meshes) {
    const TetMesh* mesh = &named;
    const auto& entry = manifest.meshes.at(name);
    files.emplace_back(named.cells.size(), [mesh, path = folder / entry.file] { adapters::write_vtu(path, *mesh); });
    files.emplace_back(named.faces.size(),
                       [mesh, path = folder / entry.surface_file] { adapters::write_vtp(path, *mesh); });
    if (!entry.cavity_file.empty())
      files.emplace_back(named.faces.size(),
                         [mesh, path = folder / entry.cavity_file] { adapters::write_cavities(path, *mesh); });
    files.emplace_back(named.faces.size(), [mesh, path = folder / entry.curve_file] {
      adapters::write_curves(path, *mesh, mesh_queries::feature_curves(*mesh));
    });
  }
  if (!bundle.labels.voxels.empty())
    files.emplace_back(bundle.labels.voxels.size(),
                       [&] { adapters::write_volume((folder / "images" / "labels.nii.gz").string(), bundle.labels); });
  std::ranges::stable_sort(files, std::greater<>(), &std::pair<std::size_t, std::function<void()>>::first);
  std::vector<std::function<void()>> tasks;
  for (auto& [size, write] : files) tasks.push_back(std::move(write));
  parallel::run_tasks(tasks);
}

void write_files(const Bundle& bundle, const Manifest& manifest, const fs::path& folder) {
  write_meshes(bundle, manifest, folder);
  write_text(folder / "recipe.toml", bundle.recipe);
  write_text(folder / "validation" / "metrics.json", certificate_json(bundle.certificate));
  write_text(folder / "validation" / "report.html", bundle.report_html);
  write_text(folder / "README.md", readme_text(manifest));
  write_text(folder / "LICENSE", license_text(manifest));
  write_text(folder / "CITATION.cff", citation_text(manifest));
  write_text(folder / "ro-crate-metadata.json", ro_crate_text(manifest, hash_files(folder)));
  for (const auto& [name, text] : bundle.logs) write_text(folder / "logs" / name, text);
}

void require_safe_name(const std::string& name, const char* kind) {
  if (!is_safe_path(name) || name.find('/') != std::string::npos)
    throw UserError(fmt::format("'{}' cannot be the name of a {}", name, kind), "bundle", "use letters, digits, _");
}

void check_names(const Bundle& bundle) {
  require_safe_names(bundle.name, bundle.version);
  for (const auto& [name, mesh] : bundle.meshes) require_safe_name(name, "mesh");
  for (const auto& [name, text] : bundle.logs) require_safe_name(name, "log");
}

/// The path of a file that the manifest names.
fs::path inside(const fs::path& folder, const std::string& path) {
  if (!is_safe_path(path))
    throw UserError("path '" + path + "' leaves the bundle", (folder / "manifest.json").string(), "");
  return folder / path;
}

TetMesh read_files(const fs::path& folder, const ManifestMesh& entry) {
  TetMesh mesh = adapters::read_vtu(inside(folder, entry.file));
  adapters::read_surface(inside(folder, entry.surface_file), mesh);
  if (!entry.cavity_file.empty()) adapters::read_cavities(inside(folder, entry.cavity_file), mesh);
  return mesh;
}

/// Bundles of before number their surfaces otherwise; the names in the manifest hold.
void retag_surfaces(const Manifest& manifest, TetMesh& mesh) {
  std::map<std::int32_t, std::int32_t> today;
  for (const auto& [name, tag] : manifest.surfaces) today[tag] = surface_from_name(name).value_or(tag);
  for (auto& tag : mesh.surface)
    if (const auto found = today.find(tag); found != today.end()) tag = found->second;
  for (auto& rim : mesh.rims)
    if (const auto found = today.find(rim.tag - rim_tag_base); found != today.end())
      rim.tag = rim_tag_base + found->second;
}

/// Bundles of before have the fibres on the walls alone, and not on the torso that the walls are part of.
void add_missing_fibers(const fs::path& folder, const Manifest& manifest, TetMesh& torso) {
  const auto walls = manifest.meshes.find("myocardium");
  if (!torso.cell_fibers.fiber.empty() || walls == manifest.meshes.end()) return;
  carry_fibers_to_parent(read_files(folder, walls->second), torso);
}

}  // namespace

void refuse_inside(const fs::path& output, const fs::path& bundle) {
  if (lies_in(output, bundle))
    throw UserError("lies in the bundle, which would no longer be what its manifest says", output.string(),
                    "name a place outside of it");
}

void require_safe_names(const std::string& name, const std::string& version) {
  require_safe_name(name, "bundle");
  require_safe_name(version, "version");
}

std::string write_bundle(const Bundle& bundle, const ReservedPlace& place, Existing existing) {
  check_names(bundle);
  Manifest manifest = describe_bundle(bundle);
  write_files(bundle, manifest, place.partial);
  manifest.files = hash_files(place.partial);
  manifest.content_id = content_id(manifest);
  write_text(place.partial / "manifest.json", manifest_text(manifest));
  move_into_place(place, existing);
  return manifest.content_id;
}

std::string write_bundle(const Bundle& bundle, const fs::path& folder, Existing existing) {
  check_names(bundle);
  return write_bundle(bundle, reserve_place(folder, existing), existing);
}

Manifest read_manifest(const fs::path& folder) {
  require_bundle_folder(folder);
  const fs::path path = folder / "manifest.json";
  if (!fs::exists(path))
    throw UserError("there is no manifest.json in it", folder.string(), "name the folder of a bundle");
  return parse_manifest(read_text(path), path.string());
}

TetMesh read_mesh(const fs::path& folder, const std::string& mesh_name) {
  const Manifest manifest = read_manifest(folder);
  const auto entry = manifest.meshes.find(mesh_name);
  if (entry == manifest.meshes.end()) {
    std::string known;
    for (const auto& [name, mesh] : manifest.meshes) known += (known.empty() ? "" : ", ") + name;
    throw UserError("there is no mesh '" + mesh_name + "'", folder.string(), "it has: " + known);
  }
  TetMesh mesh = read_files(folder, entry->second);
  retag_surfaces(manifest, mesh);
  if (mesh_name == "torso") add_missing_fibers(folder, manifest, mesh);
  return mesh;
}

LabelVolume read_labels(const fs::path& folder) {
  return adapters::read_labels((folder / "images" / "labels.nii.gz").string());
}

std::string read_recipe_text(const fs::path& folder) { return read_text(folder / "recipe.toml"); }

}  // namespace heartgen::exporters
