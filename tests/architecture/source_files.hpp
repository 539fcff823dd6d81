// SPDX-License-Identifier: GPL-3.0-or-later
// The program's sources as files.
#pragma once
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace heartgen {

namespace fs = std::filesystem;

inline const fs::path root = fs::path(HEARTGEN_TESTS_FOLDER).parent_path();

inline std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline std::vector<fs::path> sources_in(const std::vector<const char*>& folders) {
  std::vector<fs::path> found;
  for (const char* folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (const auto kind = entry.path().extension(); kind == ".cpp" || kind == ".hpp") found.push_back(entry.path());
  return found;
}

}  // namespace heartgen
