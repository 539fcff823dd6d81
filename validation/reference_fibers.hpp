// Fibres against known ones: the phantom's analytic field, or any other on a grid.
#pragma once
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heart::validation {

/// A known axis field: three components on one grid, zero where nothing is known. Signs and lengths do not matter.
struct ReferenceFibers {
  Volume<float> x, y, z;
};

/// Rows of group "fibers", scope lv_myocardium, rv_myocardium and ventricles (both): axis_error_mean and _p95 (deg)
/// over the cells whose centre lies in the known field (nearest voxel), and compared_fraction, their share. The field
/// is interpolated linearly (signs aligned) among the known voxels around the centre that belong to the same wall: in a
/// wall of two or three voxels the nearest one alone may be 30 degrees off.
Report compare_fibers(const TetMesh& myocardium, const ReferenceFibers& reference);

}  // namespace heart::validation
