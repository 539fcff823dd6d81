// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Everything a mesh from elsewhere holds, carried to the mesh that it became.
#pragma once
#include <string>

#include "generator/tetmesh/improve_mesh.hpp"
#include "model/unstructured_data.hpp"

namespace heartgen::tetmesh {

/// Names of arrays that number nodes and cells, and are made anew.
struct Ids {
  std::set<std::string> point, cell;
};

/// Ids of nodes and cells say nothing about others: those that count through the mesh are to be made anew; others, and
/// those whose name says "original", are taken out. Adds a remark on each kind. `labels` is no such array.
Ids take_out_ids(UnstructuredData& mesh, const std::string& labels);

/// Points, tetrahedra and their arrays of the improved mesh, and the triangles that are still there: all on surfaces
/// and interfaces where these did not change, else those of the new surfaces with the labels of the nearest old ones.
/// Axes keep the lengths that they had. Remarks on triangles that are gone. `labels` names the array with the regions
/// (may be empty).
UnstructuredData carried_mesh(const UnstructuredData& old, const std::string& labels, const Ids& ids,
                              const ImprovedMesh& improved);

}  // namespace heartgen::tetmesh
