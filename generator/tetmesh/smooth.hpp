// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Moves single nodes so that the worst cell around them gets better. Nodes on features stay on them, within a
/// tolerance. Freitag and Ollivier-Gooch 1997.
#pragma once
#include <cstdint>

#include "generator/tetmesh/complex.hpp"
#include "generator/tetmesh/materials.hpp"
#include "generator/tetmesh/surface_tolerance.hpp"

namespace heartgen::tetmesh {

/// Moves `node` uphill until its worst cell reaches `goal` or nothing helps. Nodes on features are
/// projected onto them or, with a tolerance, move freely within it; they stay where a face would become a misfit.
bool smooth_node(Complex& complex, const Materials& materials, std::int32_t node, double goal,
                 const SurfaceTolerance& tolerance);

/// Whether a node may be at `position`: near enough to all surfaces of its feature, and on its sides of the box.
bool is_allowed(const Complex& complex, const Materials& materials, std::int32_t node, const Vec3& position,
                double tolerance);

}  // namespace heartgen::tetmesh
