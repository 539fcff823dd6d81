// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibres of a part on the mesh that it was cut out of.
#pragma once
#include "model/tet_mesh.hpp"

namespace heartgen {

/// Gives `whole` the frames and the fibre source of `part`, node for node and cell for cell by part's parent ids; zero
/// elsewhere. Does nothing where `part` has no parent ids or no fibres. Throws UserError when an id is none of `whole`.
void carry_fibers_to_parent(const TetMesh& part, TetMesh& whole);

}  // namespace heartgen
