// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// A mesh against the label map that it was made of. The map is read as it is: interpolated here, between its voxels,
/// and never as the mesher smooths it. How well a mesher meets its own smoothed surfaces stands in rows of another
/// name.
#pragma once
#include <string>
#include <vector>

#include "model/recipe.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "validation/mesh_topology.hpp"
#include "validation/surface_distances.hpp"

namespace heartgen::validation {

/// Rows of group "mesh" for a mesh that fills all of `labels` but 0, scope `mesh_name/region`; `mesh_name` alone for
/// all regions together: volumes, Dice at the voxels' centres, pieces, handles, cavities, and distances (mm, and local
/// edges: the mean edge of the nearest face) from the mesh to the labels and from the labels to the mesh. Pieces count
/// from 100 mean cells of their region on; smaller ones are crumbs, which a mesher may drop: their volume is a row.
/// `faces` from mesh_faces.
Report check_against_labels(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                            const LabelVolume& labels, const ValidationSettings& settings);

/// Rows to_level_set and from_level_set: distances to the surfaces that the mesher itself aimed at, which tell how well
/// it meshes and nothing of how far these surfaces are from the labels. `label_at` is the mesher's region at a place;
/// it is sampled at the voxels of `grid`.
Report check_against_level_sets(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                                const Grid& grid, const LabelAt& label_at, const ValidationSettings& settings);

}  // namespace heartgen::validation
