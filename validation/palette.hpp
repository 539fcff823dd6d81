// The colours of the pictures: one table for regions, one for surfaces, one ramp for helix angles.
#pragma once
#include "model/labels.hpp"
#include "validation/canvas.hpp"

namespace heart::validation {

Rgb region_color(std::int32_t region);
Rgb surface_color(std::int32_t surface);

/// Blue (-75 degrees) over white (0) to red (+75); grey where the angle is not a number.
Rgb helix_color(double angle_deg);

/// White (0 degrees) to red (60 and more); grey where the angle is not a number.
Rgb difference_color(double angle_deg);

}  // namespace heart::validation
