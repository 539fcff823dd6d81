// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: the orifice between two pools whose blood is hardly brighter, or darker, than muscle.
///
/// No threshold shows such an orifice, but the sum over a whole section does: with blood and muscle of known grey
/// values every voxel gives an unbiased estimate of its share of blood, and the noise of thousands of voxels averages
/// out. The orifice is the disc in a plane, blood inside and muscle around, that the grey values speak for most
/// (maximum likelihood).
#pragma once
#include <optional>

#include "generator/landmarks/faint_right_heart.hpp"
#include "generator/landmarks/valve_patch.hpp"

namespace heartgen::landmarks {

/// The right heart as its grey values show it, on the grid of the image.
struct FaintTissue {
  Volume<float> open;       ///< 1 where its cavities and their muscle may be; 0 in fat, lung and the left heart
  Volume<float> excess;     ///< share of blood less one half, noise reduced, also beyond -1/2 and 1/2; 0 where the grey
                            ///< value is a mixture, -1/2 in fat and the left heart
  double nats_per_mm2 = 0;  ///< what one mm² of orifice, or of the muscle around it, tells
};

FaintTissue show_tissue(const Volume<float>& hu, const FaintRightHeart& right);

/// The orifice within 15 mm and 35 degrees of `start`; nothing where the noise would hide it.
std::optional<ValvePatch> find_orifice(const FaintTissue& tissue, const ValvePatch& start);

}  // namespace heartgen::landmarks
