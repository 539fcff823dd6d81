// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/input_files.hpp"

#include <algorithm>
#include <fstream>

namespace heartgen::pipeline {
namespace {

namespace fs = std::filesystem;

void add_folder(const fs::path& folder, std::vector<fs::path>& files) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The names that a header's line "KEY = NAME" (MetaImage) or "KEY: NAME" (NRRD) gives, and those on the lines below
/// it; empty names are harmless.
std::vector<std::string> named_in_header(const fs::path& header, const std::string& key, char separator) {
  std::ifstream stream(header, std::ios::binary);
  std::vector<std::string> names;
  for (std::string line; std::getline(stream, line);) {
    const auto at = line.find(separator);
    if (!names.empty())
      names.push_back(trimmed(line));
    else if (at != std::string::npos && trimmed(line.substr(0, at)) == key)
      names.push_back(trimmed(line.substr(at + 1)));
  }
  return names;
}

/// Where no name is that of a file, they form a pattern ("slice%03d.raw"): then any file beside the header counts.
void add_named(const fs::path& header, const std::vector<std::string>& names, std::vector<fs::path>& files) {
  const auto before = files.size();
  for (const auto& name : names) {
    const fs::path file = header.parent_path() / name;
    if (!name.empty() && fs::is_regular_file(file)) files.push_back(file);
  }
  if (files.size() == before && !names.empty())
    add_folder(header.has_parent_path() ? header.parent_path() : fs::path("."), files);
}

/// "heart.exnode.gz" with ".exnode", ".exelem": "heart.exelem.gz", "heart.exelem".
void add_partner(const std::string& path, const std::string& ending, const std::string& other,
                 std::vector<fs::path>& files) {
  const auto at = path.rfind(ending);
  if (at == std::string::npos) return;
  for (const char* zip : {"", ".gz"})
    if (const std::string file = path.substr(0, at) + other + zip; fs::is_regular_file(file)) files.emplace_back(file);
}

}  // namespace

std::vector<fs::path> files_behind(const fs::path& path) {
  std::vector<fs::path> files;
  const std::string text = path.string();
  if (fs::is_directory(path))
    add_folder(path, files);
  else
    files.push_back(path);
  if (text.ends_with(".mhd")) {
    const auto names = named_in_header(path, "ElementDataFile", '=');
    if (!names.empty() && names.front() != "LOCAL") add_named(path, names, files);
  }
  if (text.ends_with(".nhdr")) add_named(path, named_in_header(path, "data file", ':'), files);
  if (text.ends_with(".hdr")) add_partner(text, ".hdr", ".img", files);
  add_partner(text, ".exnode", ".exelem", files);
  add_partner(text, ".exelem", ".exnode", files);
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

exporters::BundleInput hash_input(const std::string& role, const std::string& path) {
  exporters::BundleInput input{role + ": " + fs::path(path).filename().string(), "", 0};
  std::string list;
  const auto files = files_behind(path);
  for (const auto& file : files) {
    input.sha256 = exporters::sha256_of_file(file);
    list += file.filename().string() + " " + input.sha256 + "\n";
    input.bytes += static_cast<std::int64_t>(fs::file_size(file));
  }
  if (files.size() != 1 || fs::is_directory(path)) input.sha256 = exporters::sha256_of_text(list);
  return input;
}

}  // namespace heartgen::pipeline
