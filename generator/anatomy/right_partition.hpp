// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The wall between the right ventricle and the right atrium, where blood hardly differs from muscle (see
/// faint_blood.hpp).
///
/// Around the tricuspid orifice the ventricle's wall ends at the valve's ring, and the atrium with its appendage lies
/// against it: fat, lung and the left heart are far away, so that no distance from them tells where this wall is. It
/// runs where the two cavities are divided, as thick as the free wall, and the grey values move it from place to place
/// to where they say it is.
#pragma once
#include "generator/anatomy/faint_blood.hpp"
#include "model/landmarks.hpp"

namespace heartgen::anatomy {

/// How far every voxel lies outside that wall, mm; negative in it. `nearest` has the tag of the cavity that every voxel
/// belongs to, `tricuspid` is open as wide as its radius, `wall_mm` is the free wall's thickness; on a grid of equal
/// spacings.
Volume<float> outside_right_partition(const Volume<float>& hu, const WallDistances& walls, const LabelVolume& nearest,
                                      const Mask& compartment, const ValvePlane& tricuspid,
                                      const FaintContrast& contrast, double wall_mm);

}  // namespace heartgen::anatomy
