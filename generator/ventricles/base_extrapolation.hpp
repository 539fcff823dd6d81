// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// What lies above the plane in which a heart's labels or an atlas's mesh end, made up from what lies below it: walls
/// end there at neither of their surfaces, so their coordinates must not see an end. Not collective; the same bits for
/// any number of threads.
#pragma once
#include "generator/ventricles/ventricles.hpp"

namespace heartgen::ventricles {

/// Continues the parts above a plane along the axis, with the slope against it that their surfaces have in the 5 mm
/// below the plane, so that walls go through it without a bend: an outflow tract leans by 45 degrees. Over 10 mm walls
/// straighten.
void extrapolate_above_base(Volume<std::uint8_t>& parts, const Plane& plane, const Vec3& axis);

}  // namespace heartgen::ventricles
