// SPDX-License-Identifier: GPL-3.0-or-later
// A bundle against its manifest.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "exporters/bundle.hpp"
#include "exporters/files.hpp"
#include "exporters/manifest.hpp"
#include "model/error.hpp"
#include "model/labels.hpp"

namespace heartgen::exporters {
namespace {

namespace fs = std::filesystem;

bool passes_a_link(const fs::path& folder, const std::string& path) {
  fs::path walked = folder;
  for (const auto& part : fs::path(path))
    if (fs::is_symlink(fs::symlink_status(walked /= part))) return true;
  return false;
}

/// What is wrong with one listed file, or "".
std::string defect_of(const fs::path& folder, const ManifestFile& file) {
  if (!is_safe_path(file.path)) return "the path leaves the bundle";
  if (!is_covered(file.path)) return "must not be listed in the manifest";
  if (passes_a_link(folder, file.path)) return "is a link";
  if (!fs::exists(folder / file.path)) return "missing";
  if (!fs::is_regular_file(folder / file.path)) return "is not a plain file";
  if (fs::file_size(folder / file.path) != static_cast<std::uintmax_t>(file.bytes)) return "size differs";
  if (sha256_of_file(folder / file.path) != file.sha256) return "SHA-256 differs";
  return "";
}

void check_mesh_entries(const Manifest& manifest, const std::set<std::string>& listed, std::vector<Problem>& problems) {
  for (const auto& [name, mesh] : manifest.meshes)
    for (const auto& path : {mesh.file, mesh.surface_file, mesh.curve_file})
      if (!path.empty() && !listed.count(path))
        problems.push_back({path, "file of mesh '" + name + "' is not in the manifest's list"});
}

/// Without control characters but ends of lines and tabs.
bool is_plain_text(const fs::path& file) {
  if (!fs::is_regular_file(file)) return false;
  const std::string text = read_text(file);
  return std::none_of(text.begin(), text.end(), [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return (code < 0x20 && c != '\n' && c != '\t') || code == 0x7f;
  });
}

/// What is wrong with a file that the manifest does not list, or "".
std::string defect_of_unlisted(const fs::path& folder, const std::string& path) {
  if (fs::is_symlink(fs::symlink_status(folder / path))) return "is a link";
  if (path == "manifest.json") return "";
  if (is_covered(path)) return "is not in the manifest";
  return is_plain_text(folder / path) ? "" : "is no log: it holds more than plain text";
}

/// The first schema's content id did not cover these: what it may say of them is known.
void check_first_schema(const Manifest& manifest, std::vector<Problem>& problems) {
  if (manifest.schema != first_bundle_schema) return;
  const auto refuse = [&](const std::string& what) { problems.push_back({"manifest.json", what}); };
  if (manifest.unit != "mm") refuse("its unit is not mm");
  if (manifest.frame != "LPS") refuse("its frame is not LPS");
  for (const auto& [name, tag] : manifest.regions)
    if (region_name(tag) != name)
      refuse(fmt::format("region '{}' has tag {}, which is '{}'", name, tag, region_name(tag)));
}

}  // namespace

std::vector<Problem> verify_bundle(const fs::path& folder) {
  require_bundle_folder(folder);
  Manifest manifest;
  try {
    manifest = read_manifest(folder);
  } catch (const UserError& error) {
    return {{"manifest.json", error.problem}};
  }
  std::vector<Problem> problems;
  std::set<std::string> listed;
  for (const auto& file : manifest.files) {
    if (!listed.insert(file.path).second) problems.push_back({file.path, "is listed twice"});
    if (const auto defect = defect_of(folder, file); !defect.empty()) problems.push_back({file.path, defect});
  }
  for (const auto& path : files_below(folder)) {
    if (listed.count(path)) continue;
    if (const auto defect = defect_of_unlisted(folder, path); !defect.empty()) problems.push_back({path, defect});
  }
  check_mesh_entries(manifest, listed, problems);
  check_first_schema(manifest, problems);
  if (content_id(manifest) != manifest.content_id)
    problems.push_back({"manifest.json", "content_id is not that of the model and its files"});
  return problems;
}

}  // namespace heartgen::exporters
