// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Signs of determinants without rounding: a floating-point filter, then exact arithmetic on sums of doubles where it
/// cannot decide. Shewchuk 1997, Adaptive precision floating-point arithmetic. Exact as long as products of three
/// coordinates neither overflow nor fall below the normal range.
#pragma once
#include "model/vec.hpp"

namespace heartgen::validation {

/// Sign of the volume of the cell (a, b, c, d): 1, 0 (exactly coplanar) or -1.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the area of (a, b, c) seen along `axis` (0, 1, 2): 1 counter-clockwise, 0 collinear, -1.
int orientation_along(int axis, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace heartgen::validation
