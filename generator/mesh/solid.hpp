// The walls of the heart as one solid.
#pragma once
#include "generator/mesh/domain.hpp"

namespace heart::mesh {

/// Signed distance (mm, negative inside, up to 3 mm or three times `thinnest_mm`) of all walls of the heart together,
/// on voxels of about `voxel_mm`: zero where the domain's walls end. But gaps narrower than `thinnest_mm` are closed,
/// fins thinner than it go, and rims become round: a ball of that diameter rolls along the outside and then along the
/// inside.
LevelSet wall_level_set(const MeshDomain& domain, double voxel_mm, double thinnest_mm);

/// Signed distance (mm, negative inside) to a mask, smoothed by `smoothing_mm`, at least by 1.3 voxels.
LevelSet smooth_distance(const Mask& mask, double smoothing_mm);

}  // namespace heart::mesh
