// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Where a mesh ends because the image does: faces of the body's outer surface that are no skin.
#pragma once
#include "generator/anatomy/padding.hpp"
#include "model/grid.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::pipeline {

/// Outer faces of `mesh` that lie where the torso's image ends get the surface fov_cut: the heart's grid, along which
/// cuts are found otherwise, is turned against them.
void label_torso_cuts(TetMesh& mesh, const Grid& torso_grid);

/// Outer faces of `mesh` that lie where the padding of the image on `grid` begins get the surface fov_cut: nothing was
/// measured beyond them.
void label_padding_cuts(TetMesh& mesh, const Grid& grid, const anatomy::Padding& padding);

}  // namespace heartgen::pipeline
