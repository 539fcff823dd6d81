// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The liver as a thick region of one grey value, around a seed or where a liver lies.
#pragma once
#include "model/vec.hpp"
#include "model/volume.hpp"

namespace heartgen::anatomy {

/// Soft tissue within `free` (voxels that are nothing else yet) with the grey value at the seed, connected over more
/// than thin contacts: the opening grows until the region has a liver's size. Root only. Throws UserError for a seed
/// outside the image or not in soft tissue, and where no opening parts the liver from its neighbours.
Mask segment_liver(const CtVolume& ct, const Mask& free, const Vec3& seed_mm);

/// The same from the thickest place of the soft tissue under the right lung. Empty unless what is found has a liver's
/// grey value, evenness, size and side: a scan that ends above the liver, or a liver that nothing parts from its
/// neighbours, gives none. The third axis of the grid is the patient's, upwards. Root only.
Mask find_liver(const CtVolume& ct, const Mask& lung, const Mask& free);

}  // namespace heartgen::anatomy
