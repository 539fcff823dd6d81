// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What an atlas's own fibres are like, beside what was carried: for the certificate.
/// Not collective; the same bits for any number of threads.
#pragma once
#include <vector>

#include "generator/fibers/registered_pair.hpp"
#include "model/depth_samples.hpp"
#include "model/fiber_atlas.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::fibers {

struct AtlasFigures {
  /// At most 20,000 places each, of equal volumes. `there`: the atlas's sample nearest, by place and depth, to each of
  /// `carried`. Two hearts are not cut and shaped alike, so that medians over all of the one and all of the other
  /// differ even where every angle is carried exactly; those at corresponding places should not.
  Both<DepthSamples> atlas, carried, there;
  /// Angle between the axes at an edge's ends, and the same by the edge's length: 99th percentiles over the edges of
  /// the atlas's cells; and how long these are, the median. All zero where the atlas has no cells.
  double jump_p99_deg = 0, turn_p99_deg_per_mm = 0, edge_p50_mm = 0;
  /// The same by the wall's thickness, off the junction: degrees over a length as long as the wall is thick. A thin
  /// wall must turn its fibres faster than a thick one to reach the same angles. Of the atlas between neighbouring
  /// voxels.
  double atlas_turn_p99_deg_per_wall = 0, carried_turn_p99_deg_per_wall = 0;
  double atlas_junction_turn_p99_deg_per_mm = 0;  ///< between neighbouring voxels of the two walls
};

/// Per node of a mesh: axes carried from the atlas. Only nodes at which `use` is not 0 and that one ventricle alone
/// decides are taken.
struct CarriedAxes {
  const TetMesh& mesh;
  const PointWalls& walls;
  const std::vector<Vec3>& atlas_mm;  ///< positions in the atlas
  const std::vector<Vec3>& fiber;     ///< unit
  const std::vector<std::uint8_t>& use;
};

AtlasFigures atlas_figures(const RegisteredPair& hearts, const FiberAtlas& atlas, const CarriedAxes& carried);

}  // namespace heartgen::fibers
