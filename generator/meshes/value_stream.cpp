#include "generator/meshes/value_stream.hpp"

#include <fstream>
#include <iterator>

namespace heart::meshes {

std::string whole_file(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) throw UserError("is a folder, not a file", path.string(), "name a file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw UserError("no such file, or no right to read it", path.string(), "check the path");
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace heart::meshes
