// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Meshes of the trachea and of a carotid: the smooth level set of the lumen's mask, its open ends cut by planes
/// perpendicular to the local axis of the vessel. Thesis 8.3.3. Not collective: call on one rank.
#pragma once
#include <vector>

#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::mesh {

/// A cut: what lies beyond the plane, and within `reach_mm` of the tip, is removed.
struct VesselEnd {
  Vec3 center_mm;        ///< where the axis meets the cut plane
  Vec3 normal;           ///< unit, along the axis, out of the vessel
  double reach_mm = 0;   ///< radius around `center_mm` in which the plane cuts
  double radius_mm = 0;  ///< of the usual section near it
};

/// Tips of the branches of a tubular mask, from cranial to caudal. Tips are the local maxima of the geodesic distance
/// inside the lumen; the axis there comes from the centroids of geodesic shells.
std::vector<VesselEnd> find_vessel_ends(const Mask& lumen);

/// The same of the branches that lead away from the voxels of `start`, which has no end there; with planes as far out
/// as the section is whole, which in a vessel that is cut flat is at the cut. In the mask's own frame, mm along its
/// axes from voxel (0, 0, 0): a turned image has the same bits.
std::vector<VesselEnd> find_vessel_ends(const Mask& lumen, const Mask& start);

/// `vessel` is Region::trachea (edge settings.trachea_edge_mm) or Region::carotid (settings.carotid_edge_mm). Faces:
/// trachea_wall, trachea_end_1.. (numbered from cranial to caudal), each end's rim a node set; likewise the carotid.
/// Throws UserError for an empty mask and for one without two ends.
TetMesh mesh_vessel(const Mask& lumen, Region vessel, const MeshSettings& settings);

}  // namespace heartgen::mesh
