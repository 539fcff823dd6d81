// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Every export format in one table. Not collective; call on one rank.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::exporters {

/// What a format's function gets: a mesh whose nodes are already in the unit asked for.
struct ExportTask {
  const TetMesh& mesh;
  std::string mesh_name;         ///< base of the file names
  std::filesystem::path folder;  ///< exists
  std::string unit = "mm";       ///< of the nodes
};

/// Paths of the files written.
using ExportFunction = std::vector<std::filesystem::path> (*)(const ExportTask& task);

struct ExportFormat {
  std::string_view name;  ///< as given to `export --to`
  std::string_view extension;
  std::string_view description;
  std::string_view unit;  ///< the unit its readers expect, "mm" where they do not care
  ExportFunction function;
};

std::span<const ExportFormat> export_formats();

/// Throws UserError naming the known formats.
const ExportFormat& find_format(std::string_view name);

/// Units per millimetre: mm 1, um 1000, cm 0.1, m 0.001. Throws UserError naming the known units.
double unit_scale(std::string_view unit);

/// Writes one mesh in one format into `folder` (made when missing) with a README and, where there are fibres, an input
/// that runs; an empty unit is the format's own. Returns the files written. Throws UserError for an unknown format or
/// unit, or a folder that cannot be written.
std::vector<std::filesystem::path> export_mesh(std::string_view format, const TetMesh& mesh,
                                               const std::string& mesh_name, const std::filesystem::path& folder,
                                               std::string_view unit = "");

}  // namespace heartgen::exporters
