// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Private to this folder: what lies around the pool that was taken for the left ventricle.
#pragma once
#include "model/labels.hpp"
#include "model/volume.hpp"

namespace heartgen::landmarks {

/// Shares of a shell 3 to 7.5 mm outside of lv_blood, without the other pools.
struct LeftWall {
  double muscle = 0;  ///< as grey as muscle
  double bone = 0;    ///< clearly brighter than the pool itself: a vertebra's cortex around its marrow
};

/// `chambers` and the smoothed image, HU, on one grid along the LPS axes.
LeftWall look_at_left_wall(const LabelVolume& chambers, const Volume<float>& smooth);

}  // namespace heartgen::landmarks
