// SPDX-License-Identifier: GPL-3.0-or-later
#include "exporters/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "model/error.hpp"
#include "model/input_file.hpp"

namespace heartgen::exporters {

std::string read_text(const std::filesystem::path& path) {
  require_input_file(path);
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) throw UserError("reading failed halfway", path.string(), "");
  return text;
}

void require_bundle_folder(const std::filesystem::path& folder) {
  if (std::filesystem::is_directory(folder)) return;
  const auto old = hidden_sibling(folder, "old");
  throw UserError(std::filesystem::exists(folder) ? "is no folder" : "no such folder", folder.string(),
                  std::filesystem::exists(old / "manifest.json")
                      ? fmt::format("a run that was stopped left a bundle as {}: rename it", old.string())
                      : "name the folder of a bundle");
}

const std::string& in_file_name(const std::string& name) {
  const bool leaves = name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos ||
                      std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  if (leaves)
    throw UserError("\"" + name + "\" cannot be part of a file's name", "export",
                    "rename it, or take a format that keeps everything in one file");
  return name;
}

bool is_safe_path(const std::string& path) {
  if (path.empty() || path.front() == '/' || path.back() == '/') return false;
  const bool odd_character = std::any_of(
      path.begin(), path.end(), [](char c) { return c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
  if (odd_character || path.find("//") != std::string::npos) return false;
  const std::filesystem::path parts(path);
  return std::none_of(parts.begin(), parts.end(), [](const auto& part) { return part == ".." || part == "."; });
}

std::vector<std::string> files_below(const std::filesystem::path& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (!entry.is_directory() || entry.is_symlink())
      paths.push_back(entry.path().lexically_relative(folder).generic_string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::filesystem::path plain_path(const std::filesystem::path& folder) {
  auto path = std::filesystem::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

std::filesystem::path hidden_sibling(const std::filesystem::path& folder, const std::string& suffix) {
  const auto path = plain_path(folder);
  return path.parent_path() / fmt::format(".{}.{}", path.filename().string(), suffix);
}

}  // namespace heartgen::exporters
