// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The mesh certificate (V1): what is measured here is recomputed from nodes and cells, whatever the mesher claims.
/// Quality: dihedral angles, radius ratio, scaled Jacobian, edge lengths, volumes; for finite volumes non-orthogonality
/// and skewness. Validity: inverted cells, manifold boundary, watertight regions, labels of boundary faces, orphans,
/// duplicates. Globally, per region, per surface.
#pragma once
#include <string>
#include <vector>

#include "model/recipe.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::validation {

/// Rows of group "mesh"; scope is `mesh_name`, `mesh_name/region` or `mesh_name/surface`. Only rows with a bound in
/// `settings`, and those that must be zero, judge. Node ids out of range are counted first, and then nothing else is.
Report check_mesh(const std::string& mesh_name, const TetMesh& mesh, const ValidationSettings& settings);

/// The same where the faces are there already, from mesh_faces.
Report check_mesh(const std::string& mesh_name, const TetMesh& mesh, const std::vector<MeshFace>& faces,
                  const ValidationSettings& settings);

}  // namespace heartgen::validation
