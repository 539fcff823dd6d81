// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// An atlas in a position and size that only its own shape decides, so that neither the frame nor the unit of its file
/// reaches what is carried from it. Not collective.
#pragma once
#include "generator/atlas/atlas.hpp"

namespace heartgen::atlas {

/// The atlas turned, moved and scaled: its centre of mass at the origin, its axes of inertia along x, y and z, the
/// farther ends towards +x and +y, and the size of a common adult heart. A proper rotation: mirror images stay mirror
/// images. A shape with two equal moments of inertia is turned about the third as it happens to come out.
FiberAtlas in_standard_pose(const FiberAtlas& atlas);

}  // namespace heartgen::atlas
