// Tetrahedral meshes in gmsh's .msh files: versions 2.2 and 4.1, text or binary. Physical names are kept.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heart::improve {

struct MshMesh {
  std::vector<Vec3> nodes;
  std::vector<Cell> cells;
  std::vector<std::int32_t> region;  ///< physical tag of the volume; that of the entity where it has none
  std::vector<Face> faces;           ///< the file's triangles
  std::vector<std::int32_t> surface;
  std::map<std::pair<int, std::int32_t>, std::string> names;  ///< (dimension, physical tag)
};

/// Throws UserError for another file, other versions, inconsistent contents, and without tetrahedra.
/// Elements other than triangles and tetrahedra are left out, as is other data.
MshMesh read_msh(const std::filesystem::path& path);

/// Version 2.2, text.
void write_msh(const std::filesystem::path& path, const MshMesh& mesh);

}  // namespace heart::improve
