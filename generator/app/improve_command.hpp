// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// heartgen improve: better angles for anybody's tetrahedral mesh.
#pragma once
#include <string>
#include <vector>

#include "generator/tetmesh/improve_mesh.hpp"

namespace heartgen::app {

struct ImproveCommand {
  std::string input, output;
  std::string region;             ///< cell array with the regions; empty: the first known name
  std::vector<std::string> drop;  ///< arrays to leave out
  tetmesh::ImproveSettings settings;
  bool json = false;
};

/// Reads any mesh (any_mesh.hpp), improves, writes .vtu, .vtk or .msh; prints angles before and after, and what was
/// left out. Arrays, triangles and ids are carried: see carry_mesh.hpp. Throws UserError, before anything is written.
int improve_command(const ImproveCommand& command);

}  // namespace heartgen::app
