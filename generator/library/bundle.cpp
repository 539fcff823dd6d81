// SPDX-License-Identifier: GPL-3.0-or-later
#include <heartgen/bundle.hpp>

namespace heartgen {
namespace bundle {

std::map<std::string, TetMesh> read_meshes(const std::filesystem::path& folder) {
  std::map<std::string, TetMesh> meshes;
  for (const auto& [name, entry] : read_manifest(folder).meshes) meshes[name] = read_mesh(folder, name);
  return meshes;
}

}  // namespace bundle
}  // namespace heartgen
