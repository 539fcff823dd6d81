// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Better angles for anybody's tetrahedral mesh; regions and surfaces stay. Not collective; everything throws
/// UserError.
#pragma once
#include <string>

#include "generator/tetmesh/improve_mesh.hpp"
#include "model/error.hpp"
#include "model/unstructured_data.hpp"

namespace heartgen {

using tetmesh::improve_mesh;
using tetmesh::ImprovedMesh;
using tetmesh::ImproveSettings;

/// A mesh with its arrays (read_any_mesh), which are carried along. `labels` names the array of regions (find_labels;
/// may be empty). What was left out is among the remarks.
UnstructuredData improved(UnstructuredData mesh, const std::string& labels, const ImproveSettings& settings = {});

/// The same of a mesh of ours: regions, labelled faces, fibres and names stay; rims where the surfaces are unchanged.
TetMesh improved(const TetMesh& mesh, const ImproveSettings& settings = {});

}  // namespace heartgen
