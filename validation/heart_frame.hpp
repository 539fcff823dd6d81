// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The directions of a heart, from its mesh alone: for views and for colours.
#pragma once
#include "model/tet_mesh.hpp"

namespace heartgen::validation {

struct HeartFrame {
  Vec3 center_mm;           ///< centroid of the left ventricle's wall
  Vec3 axis{0, 0, 1};       ///< long axis of the left ventricle, unit, towards the base
  Vec3 to_right{-1, 0, 0};  ///< unit, across the axis, from the left to the right ventricle
};

/// The axis is the direction of greatest variance of the left ventricle's wall. Its sign follows the body: the base
/// lies to the right, behind and above the apex. Without a left ventricle: the centre of all cells, axes of the body.
HeartFrame heart_frame(const TetMesh& mesh);

}  // namespace heartgen::validation
