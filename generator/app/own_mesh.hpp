// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A tetrahedral mesh of the user's own, made ready for what else takes the meshes of a bundle.
#pragma once
#include <string>
#include <vector>

#include "generator/app/commands.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::app {

struct OwnMesh {
  std::string name;  ///< of its file, without folder and ending
  TetMesh mesh;      ///< in mm; `names` holds every tag that occurs
  std::vector<std::string> remarks;
};

/// Whether a path is a mesh file, by its name, and no folder of a bundle.
bool is_own_mesh(const std::string& path);

/// Any file of any_mesh.hpp. Faces: the file's triangles, and what it does not label of the outer boundary and of
/// interfaces, with numbers of their own. Fibres: vectors per cell, or else per point, with a name of axis_name; where
/// the file has no sheets they are any directions across the fibres. `region` names the array of regions (empty: a
/// known name), `unit` is the file's: mm, um, cm or m (empty: um for openCARP's files, else mm). Throws UserError.
OwnMesh read_own_mesh(const std::string& path, const std::string& region, const std::string& unit);

/// `validate` and `export` of such a file. Return exit codes.
int validate_own_mesh(const ValidateCommand& command);
int export_own_mesh(const ExportCommand& command);

}  // namespace heartgen::app
