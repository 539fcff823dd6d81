// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Curves that a mesh must follow, as chains of overlapping balls for the mesher.
#pragma once
#include <vector>

#include "generator/adapters/cgal_mesher.hpp"
#include "model/vec.hpp"

namespace heartgen::mesh {

/// A point of a curve and the wanted distance to its neighbours on it.
struct CurvePoint {
  Vec3 position_mm;
  double spacing_mm = 0;
};

/// Walks along densely sampled curves (in any order, with branches) and keeps points about their spacing apart. The
/// balls of neighbours overlap, except where a closed curve's ends meet badly.
std::vector<adapters::CurveBall> balls_along(const std::vector<CurvePoint>& samples);

}  // namespace heartgen::mesh
