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

/// Rows of group "fibers", scope lv_myocardium and rv_myocardium: axis_error_mean and _p95 (deg) over the cells of that
/// ventricle whose centre lies in the known field (nearest voxel), and compared_fraction, their share.
Report compare_fibers(const TetMesh& myocardium, const ReferenceFibers& reference);

}  // namespace heart::validation
