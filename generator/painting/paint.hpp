// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Regions of the user's own on the cells of a mesh.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "generator/painting/region_masks.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::painting {

/// Sets user_regions and user_region of a mesh; only cells with takes(region) are painted. A cell's fraction is the
/// share of points, equally spread over it, that lie in the region's voxels. A point in several regions counts for the
/// first of them. Those cells count for a region that hold most of it, as many as keep its volume: where cells are
/// larger than the region is wide, fractions tell more.
void paint(TetMesh& mesh, const std::vector<RegionMask>& regions,
           const std::function<bool(std::int32_t region)>& takes);

/// Of a region's voxels, and of the parts of cells in it.
double volume_mm3(const Mask& mask);
double volume_mm3(const TetMesh& mesh, const UserRegion& region);

/// What a region lies beside.
struct Target {
  std::string what;                               ///< e.g. "the heart's walls"
  std::function<bool(const Vec3& lps_mm)> holds;  ///< whether a point is in it
  Vec3 low_mm, high_mm;                           ///< the box around it
};

/// The walls of a label map.
Target walls_of(const LabelVolume& labels);

/// Throws UserError, naming its file, for a region without a voxel in the target: how far away it lies, and whether it
/// would lie there with x and y turned.
void refuse_regions_elsewhere(const std::vector<RegionMask>& regions, const Target& target);

/// The user's regions of a mesh's cells on the larger mesh that it was cut out of.
void carry_regions_to_parent(const TetMesh& part, TetMesh& whole);

}  // namespace heartgen::painting
