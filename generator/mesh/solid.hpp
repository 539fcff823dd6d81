// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The walls of the heart as one solid.
#pragma once
#include "generator/mesh/domain.hpp"

namespace heartgen::mesh {

/// What is narrower than these a mesh is not asked to follow.
struct Narrowest {
  double wall_mm = 0, gap_mm = 0;
};

/// Signed distance (mm, negative inside, up to 3 mm or three times the wider of `narrowest`) of all walls of the heart
/// together, on voxels of about `voxel_mm`: zero where the domain's walls end. But narrower gaps are closed, narrower
/// fins go, and rims become round: a ball rolls along the outside and then one along the inside.
LevelSet wall_level_set(const MeshDomain& domain, double voxel_mm, const Narrowest& narrowest);

/// Signed distance (mm, negative inside) to a mask, smoothed by `smoothing_mm`, at least by 1.3 voxels.
LevelSet smooth_distance(const Mask& mask, double smoothing_mm);

}  // namespace heartgen::mesh
