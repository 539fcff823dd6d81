// The liver as a thick region of one grey value around a seed.
#pragma once
#include "model/vec.hpp"
#include "model/volume.hpp"

namespace heart::segment {

/// Soft tissue within `free` (voxels that are nothing else yet) with the grey value at the seed, connected over more
/// than thin contacts: the opening grows until the region has a liver's size. Root only. Throws UserError for a seed
/// outside the image or not in soft tissue, and where no opening parts the liver from its neighbours.
Mask segment_liver(const CtVolume& ct, const Mask& free, const Vec3& seed_mm);

}  // namespace heart::segment
