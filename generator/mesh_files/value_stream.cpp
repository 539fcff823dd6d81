// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/mesh_files/value_stream.hpp"

#include <fstream>
#include <iterator>

#include "model/input_file.hpp"

namespace heartgen::mesh_files {

std::string whole_file(const std::filesystem::path& path) {
  require_input_file(path);
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace heartgen::mesh_files
