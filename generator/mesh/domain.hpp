// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What to mesh: an implicit domain of several materials made from a label map. Mesher back ends ask only for the
/// region at a point and the wanted edge length there.
///
/// Each label's indicator is smoothed, which turns voxel stairs into smooth level sets of "shares" that add up to 1,
/// and what smoothing takes from thin and round parts is given back. Surfaces are taken in an order that keeps thin
/// walls: first blood (share of the left or of the right side of the heart above a half), then the heart as a whole,
/// and the wall is what lies between. Both faces of a thin wall are level sets of thick bodies, so that smoothing does
/// not thin it. All other regions, and the outside, compete by the largest share. Details that the torso's coarse edges
/// cannot follow are smoothed away: what is neither heart nor vessel may be smoothed more.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "generator/mesh/shares.hpp"
#include "model/labels.hpp"
#include "model/recipe.hpp"
#include "model/volume.hpp"

namespace heartgen::mesh {

constexpr std::size_t label_count = 18;

constexpr std::uint32_t bits_of(const auto& regions) {
  std::uint32_t bits = 0;
  for (const Region r : regions) bits |= 1U << tag(r);
  return bits;
}

/// What far from the heart gets edges of the torso (bit L: label L).
constexpr std::uint32_t bulk_bits =
    bits_of(std::array{Region::none, Region::lung, Region::bone, Region::liver, Region::torso});

struct MeshDomain {
  Grid grid;                                        ///< of the label map
  std::vector<FractionField> shares;                ///< ascending labels, only those that occur
  std::array<std::int8_t, label_count> share_of{};  ///< each label's place in `shares`, -1 for one that does not occur
  std::vector<std::uint8_t> voxels;                 ///< region tag at every voxel centre after smoothing
  /// Region tag of the cube between voxel centres (i, j, k) and (i+1, j+1, k+1) where it is the same in the whole
  /// cube, else `mixed`. (Shares are trilinear in a cube: equal corners mean an equal cube.)
  std::vector<std::uint8_t> cubes;
  static constexpr std::uint8_t mixed = 255;
};

/// The smoothing is at least 1.3 voxels along each axis: less would follow the stairs. Lung, bone, liver, torso and the
/// outside are smoothed by `body_smoothing_mm` if that is more. All other regions keep their volume, seen over some
/// voxels, and nearly every voxel centre that has two neighbours of its label keeps its label.
/// Throws UserError for a label that is not in the table of regions, or a map without any label.
MeshDomain make_domain(const LabelVolume& labels, double smoothing_mm, double body_smoothing_mm = 0);

/// Sets `voxels` and `cubes` from the shares where these have changed; `labels` is the map that they come from.
void update_regions(MeshDomain& domain, const LabelVolume& labels, const Spans& changed);

/// What the meshes of the heart and the torso are made of: the body's smoothing grows with its finest edges as the
/// heart's does with the heart's.
MeshDomain make_domain(const LabelVolume& labels, const MeshSettings& settings);

/// Region tag at a continuous index of the label map, 0 outside. Beyond the border voxels the map continues as it is
/// on the border.
std::uint8_t region_at(const MeshDomain& domain, const Vec3& index);

/// What region_at says in the middles of the eight parts of a cube between voxel centres (`cube` is its first voxel,
/// and has a next one along each axis), x fastest.
std::array<std::uint8_t, 8> regions_of_eighths(const MeshDomain& domain, const Index3& cube);

/// A surface of the domain near a point: `value` is 0 on it, `gradient` is per mm along the grid's axes.
struct SurfaceEquation {
  double value = 0;
  Vec3 gradient;
};

/// What the walls lie between: they are where the heart has more than a half, and the blood of neither side has.
struct HeartShares {
  float left_blood = 0, right_blood = 0, heart = 0;
};
HeartShares heart_shares(const MeshDomain& domain, const Vec3& index);

/// The equations, at a continuous index, of the place where all regions of `labels` (bit L: label L) meet: one less
/// than there are labels, by the same rules as region_at. Returns how many were written.
int equations_at(const MeshDomain& domain, std::uint32_t labels, const Vec3& index,
                 std::span<SurfaceEquation> equations);

}  // namespace heartgen::mesh
