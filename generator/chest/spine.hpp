// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The centre line of the spine.
#pragma once
#include "generator/chest/thorax.hpp"

namespace heartgen::chest {

/// The brightest smooth path from the lowest to the highest slice, between the lungs and near their back, by dynamic
/// programming over slices. `image` smoothed; `lung` on the same grid, not empty.
Spine find_spine(const Volume<float>& image, const Mask& lung);

/// The share of the heights where lungs are at which what was found is neither vertebra nor disc: an atrium or the
/// aorta that was taken for them is as bright as the other blood, and a gap as dark as lung. Spines have up to 0.11
/// (0.21 in a scan that ends below the lungs); what was taken for one has 0.2 and more, mostly more than 0.4.
double share_unlike_spine(const Spine& spine, const Volume<float>& image, const Mask& lung, double blood_hu);

/// Where the spine would be of a patient whose heart is in the middle of an image that ends before the spine.
Spine spine_behind(const Grid& grid);

}  // namespace heartgen::chest
