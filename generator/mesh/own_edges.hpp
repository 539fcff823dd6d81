// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Edge lengths that the user wants, as an image.
#pragma once
#include <vector>

#include "model/volume.hpp"

namespace heartgen::mesh {

/// The image's values (edge lengths in mm, 0: no wish) at the voxel centres of `grid`, each from the nearest voxel of
/// the image, 0 outside it. Throws UserError for negative values, for positive ones below 0.1 mm, and for an image
/// that wishes nothing inside `grid`.
std::vector<float> own_edges_on(const Volume<float>& image_mm, const Grid& grid);

}  // namespace heartgen::mesh
