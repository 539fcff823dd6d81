// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Nodes near an interface are bound to it, so that edges do not cross interfaces.
///
/// An edge crosses an interface when its ends have no label in common. Of its ends, the one nearer to the crossing
/// moves there and touches both labels from then on; forces then move it along the interface only. (Thesis 8.2, step 6,
/// projects every node nearer than half an edge; going by edges does the same where one interface is near, and chooses
/// where several are.) Where the nodes of a triangle have no label in common, more materials meet inside it: the
/// nearest node moves onto that point or curve.
#pragma once

#include "generator/distmesh/connect.hpp"
#include "generator/distmesh/nodes.hpp"

namespace heartgen::distmesh {

/// Binds nodes at crossed edges, nearest first, and at triangles without a common label. Returns how many edges inside
/// the mesh still cross. At most one node of an edge moves per call, so call it again after a new triangulation.
std::int64_t resolve_crossings(Nodes& nodes, const Simplices& simplices, const Materials& materials,
                               Dimension dimension);

/// Puts nodes where edges still cross an interface, in the middle part of an edge only, at most one per simplex.
/// Returns how many.
std::int64_t divide_crossings(Nodes& nodes, const Simplices& simplices, const Materials& materials,
                              Dimension dimension);

/// Bound nodes whose place does not touch all of their labels any more (they slid past the end of an interface) are
/// bound to what is there; free nodes get the label of their place.
void rebind(Nodes& nodes, const Materials& materials, Dimension dimension);

/// Binds nodes at the end of the mesh, `inside` being the simplices that are kept, to the outer surface or to the side
/// of the box near them. Without this nothing would hold them there: no edge leads outside.
void bind_hull(Nodes& nodes, const Simplices& inside, const Materials& materials, Dimension dimension);

/// Drops nodes that lie outside and are bound to nothing.
void drop_outside(Nodes& nodes);

}  // namespace heartgen::distmesh
