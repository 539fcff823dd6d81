// Private to this folder: the centre line of the spine.
#pragma once
#include "generator/landmarks/thorax.hpp"

namespace heart::landmarks {

/// The brightest smooth path from the lowest to the highest slice, between the lungs and near their back, by dynamic
/// programming over slices. `image` smoothed; `lung` on the same grid, not empty.
Spine find_spine(const Volume<float>& image, const Mask& lung);

}  // namespace heart::landmarks
