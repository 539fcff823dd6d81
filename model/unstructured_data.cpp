// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/unstructured_data.hpp"

#include "model/error.hpp"

namespace heartgen {
namespace {

/// "1 line", "2 lines", "1 hexahedron".
std::string counted(std::size_t count, std::string plural) {
  if (count == 1 && plural.ends_with("hedra")) plural.replace(plural.size() - 1, 1, "on");
  if (count == 1 && plural.ends_with('s')) plural.pop_back();
  return std::to_string(count) + " " + plural;
}

std::string counted(const std::map<std::string, std::size_t>& counts) {
  std::string text;
  for (const auto& [name, count] : counts) text += (text.empty() ? "" : ", ") + counted(count, name);
  return text;
}

}  // namespace

void settle_other_cells(UnstructuredData& data, const OtherCells& other, const std::filesystem::path& path) {
  if (!other.volumes.empty()) {
    const std::string beside =
        data.tets.empty() ? " and no linear tetrahedra" : " beside " + counted(data.tets.size(), "linear tetrahedra");
    throw UserError("has " + counted(other.volumes) + beside, path.string(),
                    "give linear tetrahedra only: lower the order of the elements (gmsh: Mesh.ElementOrder = 1), split "
                    "other volumes into tetrahedra");
  }
  if (data.tets.empty())
    throw UserError("there is no tetrahedron in the file", path.string(),
                    "is the file complete and of the kind its name says?");
  if (!other.lower.empty()) data.remarks.push_back("left out: " + counted(other.lower));
}

}  // namespace heartgen
