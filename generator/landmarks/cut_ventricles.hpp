// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: does the field of view hold both ventricles?
#pragma once
#include "model/volume.hpp"

namespace heartgen::landmarks {

/// The area, cm2, over which the grid's border surely cuts a ventricle: its blood ends there, or the left one's comes
/// so near that its wall does. The pools do not come near the border of a grid that holds all of them.
double ventricles_cut_cm2(const LabelVolume& chambers);

}  // namespace heartgen::landmarks
