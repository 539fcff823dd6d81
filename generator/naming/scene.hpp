// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What the naming looks at: the room between the lungs.
#pragma once
#include "generator/chest/thorax.hpp"
#include "model/crop.hpp"
#include "model/volume.hpp"

namespace heartgen::naming {

/// Fine enough for septa between blood pools, coarse enough for a second.
constexpr double spacing_mm = 2;

struct Scene {
  Volume<float> hu;             ///< along the LPS axes, around the room
  Volume<float> smooth;         ///< noise reduced: walls of 3 mm still show
  Volume<float> smoother;       ///< more of it, for gradients and weak contrast
  Mask room;                    ///< between and around the lungs, without the spine
  Volume<float> room_depth_mm;  ///< distance to what is not the room
  chest::Spine spine;
  Box view;  ///< of the whole image, in the scene's voxels
};

/// Throws UserError where there are no lungs, or for an image that is too thin.
Scene make_scene(const CtVolume& ct);

}  // namespace heartgen::naming
