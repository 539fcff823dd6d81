// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// An atlas's mesh on a grid.
#pragma once
#include "generator/ventricles/ventricles.hpp"
#include "model/fiber_atlas.hpp"

namespace heartgen::atlas {

/// Fills the mesh's cavities, tells the ventricles apart by the thickness of their walls, and cuts where the cavities
/// are no longer enclosed. The frame and the size are the atlas's own (standard_pose.hpp). Throws UserError when there
/// are not two cavities.
ventricles::AtlasImage image_of_atlas(const FiberAtlas& atlas, double spacing_mm);

}  // namespace heartgen::atlas
