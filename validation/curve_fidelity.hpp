// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The curves of a mesh where three regions meet against those of its label map: the rims of the valves' orifices, the
/// lines at which walls meet. The label map is taken as the mesher smooths it, `label_at`.
#pragma once
#include <string>
#include <vector>

#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "validation/label_fidelity.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::validation {

/// Rows of group "mesh" for the curves at which a region of the heart takes part, scope `mesh_name/curve` (see
/// curve_name) for those of at least ten edges, `mesh_name` alone for all of them together. `curve_length` in mm;
/// distances in edges of the curve. `curve_to_level_set`: from the nodes and middles of its edges to where all its
/// regions are found, in the plane across the edge. `curve_from_level_set`: from the places where three labels meet,
/// found to a quarter of a voxel, to the nearest edge of the mesh with these regions. What is farther than two edges
/// counts as two. `faces` from mesh_faces; `labels` is what the mesh was made of, `label_at` the same between its
/// voxels.
Report check_curves(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                    const LabelVolume& labels, const LabelAt& label_at);

}  // namespace heartgen::validation
