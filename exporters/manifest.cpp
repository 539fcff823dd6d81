// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/manifest.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "exporters/files.hpp"
#include "exporters/warning_json.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"
#include "model/mesh_queries/feature_curves.hpp"
#include "model/printable.hpp"

namespace heartgen::exporters {

using Json = nlohmann::json;

// The functions below are found by nlohmann::json through their arguments.
void to_json(Json& json, const BundleInput& input) {
  json = {{"name", input.name}, {"sha256", input.sha256}, {"bytes", input.bytes}};
}
void from_json(const Json& json, BundleInput& input) {
  json.at("name").get_to(input.name);
  json.at("sha256").get_to(input.sha256);
  json.at("bytes").get_to(input.bytes);
}
void to_json(Json& json, const ManifestFile& file) {
  json = {{"path", file.path}, {"sha256", file.sha256}, {"bytes", file.bytes}};
}
void from_json(const Json& json, ManifestFile& file) {
  json.at("path").get_to(file.path);
  json.at("sha256").get_to(file.sha256);
  json.at("bytes").get_to(file.bytes);
}
void to_json(Json& json, const ManifestCavity& cavity) {
  json = {{"blood", cavity.blood}, {"volume_ml", cavity.volume_ml}, {"caps", cavity.caps}};
}
void from_json(const Json& json, ManifestCavity& cavity) {
  json.at("blood").get_to(cavity.blood);
  json.at("volume_ml").get_to(cavity.volume_ml);
  json.at("caps").get_to(cavity.caps);
}
void to_json(Json& json, const ManifestMesh& mesh) {
  json = {
      {"file", mesh.file},   {"surface_file", mesh.surface_file}, {"nodes", mesh.nodes}, {"cells", mesh.cells},
      {"faces", mesh.faces}, {"regions", mesh.regions},           {"rims", mesh.rims},   {"surfaces", mesh.surfaces}};
  if (!mesh.user_regions.empty()) json["user_regions"] = mesh.user_regions;
  if (!mesh.cavity_file.empty()) {
    json["cavity_file"] = mesh.cavity_file;
    json["cavities"] = mesh.cavities;
  }
  if (mesh.curve_file.empty()) return;
  json["curve_file"] = mesh.curve_file;
  json["curves"] = mesh.curves;
}
void from_json(const Json& json, ManifestMesh& mesh) {
  json.at("file").get_to(mesh.file);
  json.at("surface_file").get_to(mesh.surface_file);
  json.at("nodes").get_to(mesh.nodes);
  json.at("cells").get_to(mesh.cells);
  json.at("faces").get_to(mesh.faces);
  json.at("regions").get_to(mesh.regions);
  json.at("rims").get_to(mesh.rims);
  json.at("surfaces").get_to(mesh.surfaces);
  if (json.contains("user_regions")) json.at("user_regions").get_to(mesh.user_regions);
  if (json.contains("cavity_file")) {
    json.at("cavity_file").get_to(mesh.cavity_file);
    json.at("cavities").get_to(mesh.cavities);
  }
  if (!json.contains("curve_file")) return;
  json.at("curve_file").get_to(mesh.curve_file);
  json.at("curves").get_to(mesh.curves);
}

namespace {

ManifestCavity describe_cavity(const TetMesh& mesh, const Cavity& cavity) {
  constexpr double mm3_per_ml = 1000;
  std::set<std::string> caps;
  for (const auto tag : cavity.surface)
    if (is_cap(tag)) caps.insert(surface_name(tag));
  return {region_name(cavity.region),
          enclosed_volume_mm3(mesh.nodes_mm, cavity.faces) / mm3_per_ml,
          {caps.begin(), caps.end()}};
}

ManifestMesh describe_mesh(const std::string& name, const TetMesh& mesh) {
  ManifestMesh result;
  result.file = "meshes/" + name + ".vtu";
  result.surface_file = "surfaces/" + name + ".vtp";
  result.curve_file = "curves/" + name + ".vtp";
  result.nodes = static_cast<std::int64_t>(mesh.nodes_mm.size());
  result.cells = static_cast<std::int64_t>(mesh.cells.size());
  result.faces = static_cast<std::int64_t>(mesh.faces.size());
  for (const auto tag : mesh.region) ++result.regions[region_name(tag)];
  for (const auto tag : mesh.surface) ++result.surfaces[surface_name(tag)];
  for (const auto& rim : mesh.rims) result.rims[rim.name] = static_cast<std::int64_t>(rim.nodes.size());
  for (const auto& curve : mesh_queries::feature_curves(mesh))
    result.curves[mesh_queries::curve_name(curve)] = static_cast<std::int64_t>(curve.edges.size());
  for (const auto& region : mesh.user_regions)
    result.user_regions[region.name] = std::count(mesh.user_region.begin(), mesh.user_region.end(), region.tag);
  if (!mesh.cavities.empty()) result.cavity_file = "cavities/" + name + ".vtp";
  for (const auto& cavity : mesh.cavities) result.cavities[cavity.name] = describe_cavity(mesh, cavity);
  return result;
}

Json manifest_json(const Manifest& m) {
  Json json = {{"schema", m.schema},   {"name", m.name},         {"version", m.version},
               {"license", m.license}, {"author", m.author},     {"date_published", m.date_published},
               {"atlas", m.atlas},     {"unit", m.unit},         {"frame", m.frame},
               {"regions", m.regions}, {"surfaces", m.surfaces}, {"rims", m.rims},
               {"meshes", m.meshes},   {"files", m.files},       {"content_id", m.content_id},
               {"inputs", m.inputs},   {"tools", m.tools}};
  if (!m.attribution.empty()) json["attribution"] = m.attribution;
  if (!m.user_regions.empty()) json["user_regions"] = m.user_regions;
  if (!m.caps.empty()) json["caps"] = m.caps;
  if (!m.torso_from_heart.empty()) json["torso_from_heart"] = m.torso_from_heart;
  if (!m.warnings.empty()) json["warnings"] = m.warnings;
  if (!m.uses.empty()) json["uses"] = m.uses;
  return json;
}

// File names in another encoding than UTF-8 must not stop a build: such bytes are replaced.
std::string canonical_text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); }

std::string first_content_id(const std::vector<ManifestFile>& files) {
  std::vector<std::string> lines;
  lines.reserve(files.size());
  for (const auto& file : files) lines.push_back(file.path + " " + file.sha256 + "\n");
  std::sort(lines.begin(), lines.end());
  std::string text;
  for (const auto& line : lines) text += line;
  return sha256_of_text(text);
}

Manifest manifest_from(const Json& json) {
  Manifest m;
  json.at("schema").get_to(m.schema);
  json.at("name").get_to(m.name);
  json.at("version").get_to(m.version);
  json.at("license").get_to(m.license);
  json.at("author").get_to(m.author);
  m.attribution = json.value("attribution", "");
  json.at("date_published").get_to(m.date_published);
  json.at("atlas").get_to(m.atlas);
  json.at("unit").get_to(m.unit);
  json.at("frame").get_to(m.frame);
  json.at("regions").get_to(m.regions);
  json.at("surfaces").get_to(m.surfaces);
  json.at("rims").get_to(m.rims);
  json.at("meshes").get_to(m.meshes);
  json.at("files").get_to(m.files);
  json.at("content_id").get_to(m.content_id);
  json.at("inputs").get_to(m.inputs);
  json.at("tools").get_to(m.tools);
  if (json.contains("user_regions")) json.at("user_regions").get_to(m.user_regions);
  if (json.contains("caps")) json.at("caps").get_to(m.caps);
  if (json.contains("torso_from_heart")) json.at("torso_from_heart").get_to(m.torso_from_heart);
  if (json.contains("warnings")) json.at("warnings").get_to(m.warnings);
  if (json.contains("uses")) json.at("uses").get_to(m.uses);
  return m;
}

/// What a manifest names becomes names of files, and is printed.
void refuse_hostile_names(const Json& json, const std::string& path) {
  const auto refuse = [&](const std::string& what) {
    throw UserError("malformed manifest: " + what, path, "do not use this bundle: heartgen did not write it");
  };
  for (const auto& [name, mesh] : json.at("meshes").items())
    if (!is_safe_path(name) || name.find('/') != std::string::npos) refuse("'" + name + "' cannot be a mesh's name");
  const Json flat = json.flatten();
  for (const auto& [key, value] : flat.items())
    if (!is_printable(key) || (value.is_string() && !is_printable(value.get<std::string>())))
      refuse("it holds control characters");
}

}  // namespace

bool is_covered(const std::string& path) {
  const std::filesystem::path parts(path);
  return path != "manifest.json" && !(parts.parent_path() == "logs" && parts.extension() == ".log");
}

std::string content_id(const Manifest& manifest) {
  if (manifest.schema == first_bundle_schema) return first_content_id(manifest.files);
  Json json = manifest_json(manifest);
  for (const char* key : {"content_id", "inputs", "tools"}) json.erase(key);
  return sha256_of_text(canonical_text(json));
}

std::vector<ManifestFile> hash_files(const std::filesystem::path& folder) {
  std::vector<ManifestFile> files;
  for (const auto& path : files_below(folder))
    if (is_covered(path))
      files.push_back(
          {path, sha256_of_file(folder / path), static_cast<std::int64_t>(std::filesystem::file_size(folder / path))});
  return files;
}

Manifest describe_bundle(const Bundle& bundle) {
  Manifest m;
  m.schema = bundle_schema;
  m.name = bundle.name;
  m.version = bundle.version;
  m.license = printable(bundle.license);
  m.author = printable(bundle.author);
  m.attribution = printable(bundle.attribution);
  m.date_published = bundle.date_published;
  m.atlas = printable(bundle.atlas);
  m.unit = "mm";
  m.frame = "LPS";
  m.inputs = bundle.inputs;
  for (auto& input : m.inputs) input.name = printable(input.name);
  m.tools = bundle.tools;
  m.torso_from_heart = bundle.torso_from_heart;
  m.warnings = bundle.certificate.warnings;
  for (auto& warning : m.warnings) warning.text = printable(warning.text);
  m.uses = bundle.certificate.uses;
  std::array<bool, 256> in_labels{};
  for (const auto voxel : bundle.labels.voxels) in_labels[voxel] = true;
  std::set<std::int32_t> regions, surfaces;
  for (std::int32_t tag = 1; tag < 256; ++tag)
    if (in_labels[static_cast<std::size_t>(tag)]) regions.insert(tag);
  for (const auto& [name, mesh] : bundle.meshes) {
    m.meshes[name] = describe_mesh(name, mesh);
    regions.insert(mesh.region.begin(), mesh.region.end());
    surfaces.insert(mesh.surface.begin(), mesh.surface.end());
    for (const auto& rim : mesh.rims) m.rims[rim.name] = rim.tag;
    for (const auto& region : mesh.user_regions) m.user_regions[region.name] = region.tag;
    for (const auto& cavity : mesh.cavities)
      for (const auto tag : cavity.surface)
        if (is_cap(tag)) m.caps[surface_name(tag)] = tag;
  }
  for (const auto tag : regions) m.regions[region_name(tag)] = tag;
  for (const auto tag : surfaces) m.surfaces[surface_name(tag)] = tag;
  return m;
}

std::string manifest_text(const Manifest& manifest) {
  Json json = manifest_json(manifest);
  json["manifest_sha256"] = sha256_of_text(canonical_text(json));
  return canonical_text(json) + "\n";
}

Manifest parse_manifest(const std::string& text, const std::string& path) {
  const std::string remedy = "is this the folder of a bundle, and is it whole?";
  try {
    const Json json = Json::parse(text);
    Manifest manifest = manifest_from(json);
    if (manifest.schema != bundle_schema && manifest.schema != first_bundle_schema)
      throw UserError("schema '" + manifest.schema + "' is not known to this version", path, "use a newer heartgen");
    if (manifest_text(manifest) != text) throw UserError("has been altered: manifest_sha256 differs", path, remedy);
    refuse_hostile_names(json, path);
    return manifest;
  } catch (const Json::exception& error) {
    throw UserError(std::string("malformed manifest: ") + error.what(), path, remedy);
  } catch (const std::invalid_argument& error) {
    throw UserError(std::string("malformed manifest: ") + error.what(), path, remedy);
  }
}

}  // namespace heartgen::exporters
