// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Analytic domains for the mesher's benchmark: a thesis-size pair of ventricles, and walls of random shape.
#pragma once
#include <array>
#include <cstdint>
#include <functional>

#include "generator/tetmesh/materials.hpp"

namespace heartgen::benchmarks {

/// Material i + 1 is where fields[i] is the first positive one (mm, about a distance); outside none is positive.
struct AnalyticDomain {
  Vec3 box_min_mm, box_max_mm;
  std::array<std::function<double(const Vec3&)>, 3> fields;  ///< empty ones after the last
  double edge_mm = 1;
};

/// One material: two ventricles with papillary muscles, cut flat at the base; about 190 ml.
AnalyticDomain ventricles(double edge_mm);

/// Two pools of blood and the wall around them: random pose, wall of 1.5 to 5 mm, bumps, waves of the wall's level set.
AnalyticDomain random_walls(std::uint32_t seed);

tetmesh::Materials materials_of(const AnalyticDomain& domain);

}  // namespace heartgen::benchmarks
