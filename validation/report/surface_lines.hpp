// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Lines along axes that are given on the points of a triangulated surface, drawn on the surface itself.
#pragma once
#include <cstdint>
#include <vector>

#include "validation/report/view_surfaces.hpp"

namespace heartgen::report {

struct SurfaceLine {
  std::vector<Vec3> points_mm;
  std::vector<std::uint32_t> nearest;  ///< per point, a corner of the triangle that it lies in
};

/// Through one triangle per cube of `spacing_mm`, up to `length_mm` in all. A line ends at the rim, at a folded edge,
/// and where the axis stands more than 70 degrees out of the surface. None without axes.
std::vector<SurfaceLine> surface_lines(const ViewPart& part, double spacing_mm, double length_mm);

}  // namespace heartgen::report
