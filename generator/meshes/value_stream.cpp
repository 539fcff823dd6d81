#include "generator/meshes/value_stream.hpp"

#include <fstream>
#include <iterator>

#include "model/input_file.hpp"

namespace heart::meshes {

std::string whole_file(const std::filesystem::path& path) {
  require_input_file(path);
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace heart::meshes
