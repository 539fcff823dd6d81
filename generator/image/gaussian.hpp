// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Gaussian smoothing with a width in mm, separable, any spacing; the border value is continued.
#pragma once
#include "model/volume.hpp"

namespace heartgen::image {

/// Axes whose spacing is more than three times `sigma_mm` stay as they are: there the kernel is a single voxel.
Volume<float> gaussian(const Volume<float>& image, double sigma_mm);

}  // namespace heartgen::image
