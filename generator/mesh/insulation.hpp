// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The fibrous annuli, which keep the waves of the atria from the ventricles, on a finished mesh.
#pragma once
#include <cstdint>
#include <string>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

/// How atria and ventricles are kept apart.
enum class Insulation : std::uint8_t {
  layer,  ///< the cells of the atria's walls that share a node with ventricular muscle are la_annulus and ra_annulus
  split,  ///< the walls have two nodes at each place where both meet
  none,
};

/// Throws UserError, naming mesh.insulation, for another text.
Insulation insulation_named(const std::string& name);

/// Gives cells to the annuli. Their faces keep their labels, and against their own wall they get annulus_border, behind
/// all other faces.
void add_annuli(TetMesh& mesh);

/// Gives the cells of the atria's walls nodes of their own where they share some with ventricular muscle, at the same
/// place, behind all other nodes. Faces between both are listed twice, once for each side. Rims hold both nodes;
/// cavities of the atria have the atria's nodes, those of the ventricles the ventricles'.
void split_nodes(TetMesh& mesh);

/// What the mesh was before add_annuli.
void take_out_annuli(TetMesh& mesh);

/// What the mesh was before split_nodes: nodes at the end of the list that lie where an earlier one lies go.
void merge_split_nodes(TetMesh& mesh);

}  // namespace heartgen::mesh
