// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Tetrahedral meshes of TetGen and Chaste: NAME.node, NAME.ele and NAME.face, text; Chaste's NAME.axi and NAME.ortho.
#pragma once
#include <filesystem>

#include "model/unstructured_data.hpp"

namespace heartgen::mesh_files {

/// `path` is any one of the files; all but .node and .ele may be absent. The first attribute of an element is its
/// "region", the marker of a face its label, the axes of .axi and .ortho are "fiber", "sheet" and "sheet_normal";
/// further attributes are arrays "attribute_2" ... Throws UserError for files that are cut off or contradict each
/// other.
UnstructuredData read_tetgen(const std::filesystem::path& path);

}  // namespace heartgen::mesh_files
