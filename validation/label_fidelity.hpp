// A mesh against the label map that it was made of: volumes, topology, and the distance between their surfaces both
// ways. Nothing the mesher says is used; the surfaces between labels are found anew by halving intervals.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "model/recipe.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "validation/mesh_topology.hpp"

namespace heart::validation {

/// Region tag at a place (LPS mm), 0 outside everything: the label map as it is meant between its voxels. Called from
/// several threads.
using LabelAt = std::function<int(const Vec3& lps_mm)>;

/// Rows of group "mesh" for a mesh that fills all of `labels` but 0, scope `mesh_name/region`; `mesh_name` alone for
/// all regions together. Pieces count from 100 mean cells of their region on; in the heart none may be added or lost.
/// Only the regions of the heart are judged: around it the mesh is as coarse as asked. Of the distances, `from_labels`.
/// Distances are in mm and in local edges (mean edge of the nearest face). `to_labels`: from faces and their nodes to
/// where the region changes, along the face's normal or, where that leads farther than a twentieth of an edge, along
/// the one of many directions in which it is nearest; what is farther than three edges counts as three. `from_labels`:
/// from where it changes between neighbouring voxels to the nearest face of that region's boundary. At most 200,000
/// samples each, evenly taken. Crumbs of the label map, pieces that small, take no part, and strands and layers thinner
/// than an edge none in `from_labels`; the volume of the crumbs is a row of its own. `faces` from mesh_faces.
Report check_against_labels(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                            const LabelVolume& labels, const LabelAt& label_at, const ValidationSettings& settings);

}  // namespace heart::validation
