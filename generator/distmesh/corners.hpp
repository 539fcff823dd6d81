// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The points of a plane where three materials meet, or two at a side of the box: known before any node moves.
#pragma once
#include "generator/distmesh/nodes.hpp"

namespace heartgen::distmesh {

/// The corners of the box that lie in a label.
Nodes box_corners(const Materials& materials, Dimension dimension);

/// Adds the points where interfaces meet, found on a grid of samples `step_mm` apart; of points nearer than half an
/// edge to another one, the first is taken. Two dimensions only.
void add_meeting_points(Nodes& nodes, const Materials& materials, double step_mm);

/// Adds nodes an edge apart along the sides of the box: between two corners no other node would be at the hull, and
/// nothing would be bound there. None within half an edge of another. Two dimensions only.
void add_side_nodes(Nodes& nodes, const Materials& materials);

}  // namespace heartgen::distmesh
