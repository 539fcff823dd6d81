// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A tetrahedral mesh of the user's own, made ready for what else takes the meshes of a bundle.
#pragma once
#include <string>

#include "generator/app/commands.hpp"

namespace heartgen::app {

/// Whether a path is a mesh file, by its name, and no folder of a bundle.
bool is_own_mesh(const std::string& path);

/// `validate` and `export` of such a file. Return exit codes.
int validate_own_mesh(const ValidateCommand& command);
int export_own_mesh(const ExportCommand& command);

}  // namespace heartgen::app
