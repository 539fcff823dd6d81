// heartgen improve: better angles for anybody's tetrahedral mesh.
#pragma once
#include <string>
#include <vector>

#include "generator/improve/improve_mesh.hpp"

namespace heart::app {

struct ImproveCommand {
  std::string input, output;
  std::string region;             ///< cell array with the regions; empty: the first known name
  std::vector<std::string> drop;  ///< arrays to leave out
  improve::ImproveSettings settings;
  bool json = false;
};

/// Reads .vtu, .vtk or .msh, improves, writes; prints angles before and after. Arrays are carried: see carry_data.hpp.
/// Throws UserError, before anything is written, for an array that numbers nodes or cells and is not in `drop`.
int improve_command(const ImproveCommand& command);

}  // namespace heart::app
