// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Papillary muscles and bands in blood that hardly differs from muscle.
///
/// A muscle of a few mm across is far too small for its surface to be paid for by the contrast (see faint_blood.hpp),
/// yet the grey values inside a whole papillary muscle add up. So they are sought as what they are, rods with round
/// ends, as blurred as the image shows them: the sum of the evidence along lines of thirteen directions gives the first
/// guesses, the best rod near each is found by moving its ends and its radius, and the best ones are kept that chance
/// does not explain. What chance does is seen in the same image mirrored at blood's grey value: there is no muscle in
/// it, but as much noise of the same grain.
#pragma once
#include <optional>
#include <vector>

#include "model/volume.hpp"

namespace heartgen::anatomy {

/// A rod with round ends. Millimetres along the grid's axes from the first voxel's centre.
struct MuscleBundle {
  Vec3 from_mm, to_mm;
  double radius_mm = 0;
  double nats = 0;  ///< evidence inside
};

/// What muscles of a ventricle are held by: every one stands on the wall, and one that is free at its other end holds a
/// leaflet, so that it points to the orifice; a band is fast at both ends. A heart's anatomy makes most rods that noise
/// draws impossible.
struct MuscleAnchors {
  Volume<float> from_wall_mm;  ///< on the evidence's grid
  std::optional<Vec3>
      orifice_mm;  ///< middle of the inflow's valve, along the grid's axes from the first voxel's centre
};

/// Bundles of at least 13 nats, and of 1.3 times what chance reaches, the surest first; none overlaps a surer one.
/// `evidence`: nats per mm³ that speak for muscle, negative for blood, 0 where none is sought; on a grid of equal
/// spacings. Nothing is found that is far more than muscle: more than three times `muscle_evidence`, the evidence of
/// muscle's mean grey value. Without `anchors` a bundle may be anywhere.
std::vector<MuscleBundle> find_muscle_bundles(const Volume<float>& evidence, double muscle_evidence,
                                              const std::optional<MuscleAnchors>& anchors = {});

/// Makes `blood` (positive inside, about mm near its contour) negative in the bundles, `where` is set.
void carve_bundles(const std::vector<MuscleBundle>& bundles, const Mask& where, Volume<float>& blood);

}  // namespace heartgen::anatomy
