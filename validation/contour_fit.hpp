// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// How well contours lie on the image: distance from a mesh's surfaces to the strongest edge of the CT along their
/// normals, and agreement of two label maps (Dice, mean and Hausdorff distances).
#pragma once
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::validation {

struct ContourFitSettings {
  double reach_mm = 5;                      ///< the edge is looked for this far, or halfway to the next surface
  double step_mm = 0.25;                    ///< sampling of the normal; the peak is refined by a parabola
  double minimum_edge_hu_per_mm = 15;       ///< weaker edges are no edges: the sample is left out
  std::size_t samples_per_surface = 20000;  ///< faces taken per surface at most, evenly spread over the list
};

/// Rows of group "fit", one set per surface: edge_distance_median / _p95 / _max (of the absolute value for the last
/// two, signed for the median: positive where the image's edge lies on the outside of the surface), in mm and in voxels
/// (of the geometric mean spacing), and edge_found, the share of samples with an edge. The median is judged.
/// The outside of an interface is the side of the region with the larger tag.
Report check_contour_fit(const TetMesh& mesh, const CtVolume& ct, const ContourFitSettings& settings = {});

/// Rows of group "fit", scope = region name: dice, surface_distance_mean, surface_distance_p95 (both ways, symmetric)
/// and surface_distance_max (Hausdorff), for each region of our map, and each of the heart in the reference
/// (what else a model does not hold is not scored). Our map is resampled to the reference's grid by the nearest voxel
/// where grids differ. The reference's great vessels count as far from the chambers as ours reach. Distances are
/// missing where one side is empty.
Report compare_labels(const LabelVolume& ours, const LabelVolume& reference);

}  // namespace heartgen::validation
