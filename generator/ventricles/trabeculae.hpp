// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The compact wall of a ventricle: trabeculae run along the heart and have no helix, and what lies under them would
/// get too large a depth if they counted as wall.
#pragma once
#include "generator/ventricles/ventricles.hpp"

namespace heartgen::ventricles {

/// Voxels of `wall` (lv_wall or rv_wall) that belong to ridges become the cavity: those farther from the wall's outer
/// surface than the wall is thick around them. The thickness is opened (a low, then a high quantile, over endocardium
/// within 6 mm): ridges narrower than 12 mm vanish, whatever the wall's curvature; wide bulges and pits stay, and so
/// does all that is within 9 mm, or the wall's thickness, of what lies beyond a valve.
/// Not collective; the same bits for any number of threads.
void give_trabeculae_to_cavity(Volume<std::uint8_t>& parts, Part wall);

}  // namespace heartgen::ventricles
