// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fibres against known ones: the phantom's analytic field, or any other on a grid.
#pragma once
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::validation {

/// A known axis field: three components on one grid, zero where nothing is known. Signs and lengths do not matter.
struct ReferenceFibers {
  Volume<float> x, y, z;
};

/// Rows of group "fibers", scope lv_myocardium, rv_myocardium and ventricles (both): axis_error_mean and _p95 (deg)
/// over the voxel centres of the known field that lie in the region's cells, and compared_fraction, their share of all
/// voxel centres there. It is the nodes' field that is compared, interpolated in the cell: the known field itself is
/// taken only where it is known, for in a wall of two or three voxels half of one is worth 20 degrees.
Report compare_fibers(const TetMesh& myocardium, const ReferenceFibers& reference);

}  // namespace heartgen::validation
