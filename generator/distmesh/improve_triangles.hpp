// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Raises the least angles of a triangle mesh of several materials: nodes move, edges flip, shrink to a node or get one
/// in the middle, and tips of a material too sharp for a triangle are cut off.
#pragma once
#include <cstdint>

#include "generator/distmesh/triangles.hpp"

namespace heartgen::distmesh {

struct TriangleGoal {
  double angle_deg = 31;    ///< that every angle should have; then none is above 180 minus twice this
  int sweeps = 16;          ///< over the triangles below the goal, at most
  double tolerance = 0.12;  ///< how far nodes may leave interfaces at most, in edges; used in the last sweeps only
  double tip = 0.5;         ///< depth, in edges, of the tips that may change their label
};

/// A change is kept only if it helps the triangles around and lowers none of them below the worst of before. Nodes keep
/// to the interfaces, corners and sides of the box that they touch. Returns how many triangles stay below the goal.
std::int64_t improve_triangles(Triangles& mesh, const Materials& materials, const TriangleGoal& goal);

}  // namespace heartgen::distmesh
