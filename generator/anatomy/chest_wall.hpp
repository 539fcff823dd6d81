// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Ribs, muscles and skin in front of and beside the lungs.
#pragma once
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// Dark pieces of 20 ml and more, less empty than the air of the room; `smooth_hu` may be a part of the chest.
Mask lungs_of(const Volume<float>& smooth_hu);

/// What lies outside of the lungs' convex hull, slice by slice (constant k), and nearer to a lung than to the rest of
/// that hull: no heart is there. Behind the sternum and beside the spine the hull ends in no lung, so that nothing is
/// said there, nor in slices with little lung.
Mask beyond_the_lungs(const Mask& lung);

}  // namespace heartgen::anatomy
