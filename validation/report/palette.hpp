// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The colours of the pictures: one table for regions, one for surfaces. Ramps are in web/colors.js.
#pragma once
#include "model/labels.hpp"
#include "validation/report/canvas.hpp"

namespace heartgen::report {

Rgb region_color(std::int32_t region);
Rgb surface_color(std::int32_t surface);

}  // namespace heartgen::report
