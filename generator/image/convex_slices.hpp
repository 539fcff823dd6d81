// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The convex hull of a mask in each slice.
#pragma once
#include "model/volume.hpp"

namespace heartgen::image {

/// Fills the convex hull of every slice (constant k) with at least `smallest_mm2` of mask; other slices stay empty.
Mask convex_slices(const Mask& mask, double smallest_mm2);

}  // namespace heartgen::image
