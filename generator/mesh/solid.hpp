// Several regions of a label map as one solid: a level set, and the materials that the lattice mesher takes.
#pragma once
#include "generator/lattice/materials.hpp"
#include "generator/mesh/domain.hpp"

namespace heart::mesh {

/// Signed distance (mm, negative inside) of the union of the regions that `belongs` accepts, on voxels of about
/// `voxel_mm`, smoothed by `smoothing_mm`. Gaps narrower than `thinnest_mm` are closed, and fins thinner than it go.
/// Distances may be smoothed more than shares: a wall of two voxels keeps both its surfaces, and only its rims become
/// round. `voxel_mm` is positive, `smoothing_mm` at least 0; what is less than the stairs of the voxels is raised.
LevelSet solid_level_set(const MeshDomain& domain, bool (*belongs)(Region), double voxel_mm, double smoothing_mm,
                         double thinnest_mm);

/// Label 1 where the level set is negative, in mm along the axes of its grid, voxel (0, 0, 0) at the origin. Edges are
/// `edge_mm` long up to so far from the surface, and then grow by `growth` per mm. The level set must outlive the
/// result.
lattice::Materials materials_of(const LevelSet& solid, double edge_mm, double growth);

}  // namespace heart::mesh
