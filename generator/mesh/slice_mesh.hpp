// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The mesh of a transverse slice of the thorax with four subdomains: myocardium, heart cavities, lungs, and the
/// remaining torso. Thesis 8.3.1. Nodes in LPS mm. Not collective: call on one rank.
#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "model/tri_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::mesh {

struct SliceSettings {
  double edge_mm = 0.5;       ///< edge length in the myocardium; half of it at interfaces
  double torso_edge_mm = 6;   ///< far from the heart, at most
  double growth = 0.12;       ///< increase of the edge length per mm of distance from the myocardium
  double smoothing_mm = 0.8;  ///< of the label map before curves are taken; at least 0.6 pixels
  int iterations = 120;       ///< of the truss
};

/// What was measured on a slice's mesh.
struct SliceReport {
  double min_angle_deg = 0, greatest_angle_deg = 0;
  std::int64_t outside_bounds = 0;            ///< triangles with an angle outside [28, 120] degrees
  double distance_p99 = 0, distance_max = 0;  ///< of interface edges (ends and middles) to their curve, in edges
  std::map<std::string, double> area_mm2, curve_area_mm2;  ///< per region: of its triangles, and inside its curves
  double seconds_truss = 0, seconds_improve = 0;
};

/// Slice `index` along the third axis of the label map. Parts too narrow for the wanted edges get shorter ones, down to
/// half a pixel. Throws UserError for an index outside the map, a slice without a label, an unknown label, settings
/// that are not positive, and edges that would give more than 20 million triangles.
TriMesh mesh_slice(const LabelVolume& labels, std::int64_t index, const SliceSettings& settings,
                   SliceReport* report = nullptr);

/// The slice nearest to a height (LPS z, mm). Throws UserError when it lies more than half a slice outside the map.
std::int64_t slice_at_height(const Grid& grid, double z_mm);

}  // namespace heartgen::mesh
