// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Floods of a mask from seeds: the marker watershed that divides the blood among its chambers, and distances along
/// the inside of a vessel.
#pragma once
#include <vector>

#include "model/landmarks.hpp"
#include "model/volume.hpp"

namespace heartgen::image {

/// Faces of the grid that a flood must not cross: those cut by a valve's disc.
struct ValveBarrier {
  explicit ValveBarrier(const Grid& grid) : side(grid) {}
  Volume<std::uint8_t> side;  ///< bit n: near disc n; bit 4 + n: on the positive side of its plane

  /// Whether the face between two neighbouring voxels is cut by a disc.
  bool blocks(std::size_t a, std::size_t b) const {
    const auto both_near = static_cast<unsigned>(side.voxels[a] & side.voxels[b] & 15U);
    const auto apart = static_cast<unsigned>((side.voxels[a] ^ side.voxels[b]) >> 4U);
    return (both_near & apart) != 0;
  }
};

/// Discs of the valves (at most four), each widened by `margin_mm`.
ValveBarrier valve_barrier(const Grid& grid, const Landmarks& landmarks, double margin_mm);

struct Marker {
  std::uint8_t label;
  Index3 voxel;
};

/// Every voxel of the mask gets the label of the marker with the widest way to it, the width of a way being its
/// least `depth` (distance to the wall, mm): lines fall on constrictions, and never are crossed by a barrier. Voxels
/// without a way stay 0. Meyer 1994.
LabelVolume flood_from_markers(const Mask& mask, const Volume<float>& depth_mm, const std::vector<Marker>& markers,
                               const ValveBarrier& barrier);

/// Length (mm) of the shortest way inside the mask from the start voxels, over 26 neighbours; infinity where there
/// is none or where it is longer than `limit_mm`.
Volume<float> geodesic_distance(const Mask& mask, const Mask& start, double limit_mm);

}  // namespace heartgen::image
