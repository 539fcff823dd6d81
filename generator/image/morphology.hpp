// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Dilation, erosion, opening and closing of masks by a ball: row by row of it where it is small, else through distance
/// transforms, whose cost does not depend on the radius. The outside of the grid counts as a continuation of its
/// border.
#pragma once
#include "model/volume.hpp"

namespace heartgen::image {

Mask dilate(const Mask& mask, double radius_mm);
Mask erode(const Mask& mask, double radius_mm);
Mask open(const Mask& mask, double radius_mm);
Mask close(const Mask& mask, double radius_mm);

Mask intersect(const Mask& a, const Mask& b);
Mask unite(const Mask& a, const Mask& b);
Mask subtract(const Mask& a, const Mask& b);
std::int64_t count(const Mask& mask);

}  // namespace heartgen::image
