// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The spinal canal: soft tissue that the vertebrae close around, slice by slice, and that must not be filled as their
/// marrow is.
#pragma once
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// The part of `filled` that is spinal canal, with one voxel of its blurred rim. `filled`: bone with its holes filled
/// in every slice; `wall`: bone and all else too bright for the canal; `front_mm`: the canal lies behind this LPS y.
/// It is the longest way up through the image that is free of `wall` and has wall on most sides: marrow ends at the
/// end plates of its vertebra. All 0 where no such way is as long as two vertebrae. Not collective.
Mask find_spinal_canal(const Mask& filled, const Mask& wall, double front_mm);

}  // namespace heartgen::anatomy
