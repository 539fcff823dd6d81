// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// DistMesh: nodes in a truss of bars that push, with every interface between materials respected. Persson and Strang
/// 2004; interfaces and size field: thesis 8.2.
///
/// 1. Nodes are laid out by the wanted edge length (start.hpp).
/// 2. Their Delaunay simplices give the bars. A bar of length L pushes its ends apart with the force max(L0 - L, 0),
///    where L0 is the wanted length times `pressure`, scaled so that all bars together have the size of the truss.
/// 3. Nodes move by a share of their force. Bound nodes are brought back to their interface by Newton's method on its
///    equations: the step value / |gradient|^2 * gradient, thesis (8.2) without the need of a signed distance.
/// 4. After every new triangulation edges that cross interfaces are resolved (bind.hpp); bars far too short lose an
///    end, bars far too long get a node in the middle.
/// 5. It ends when no node moves by more than a small share of its edge, or after `iterations`.
/// Same input, same bits.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "generator/distmesh/connect.hpp"
#include "generator/distmesh/nodes.hpp"

namespace heartgen::distmesh {

struct TrussSettings {
  int iterations = 120;
  double pressure = 1.2;       ///< bars want to be this much longer than there is room; 1.1 in three dimensions
  double step = 0.2;           ///< of the force, per iteration
  double retriangulate = 0.1;  ///< the bars are found anew when nodes have moved by so many edges since they were,
  double moved_share = 0.01;   ///< so large a share of all nodes
  double still = 0.002;        ///< movement (in edges) per iteration at which the truss is at rest
  double shortest_bar = 0.55, longest_bar = 1.6;  ///< in wanted lengths: beyond, nodes are removed and added
  std::function<void()> on_tenth;                 ///< called after each tenth of the iterations, if there is one
  std::vector<Vec3> fixed_mm;                     ///< nodes at corners and rims that the mesh must have
};

/// The settings that suit a dimension.
TrussSettings default_settings(Dimension dimension);

struct Truss {
  Nodes nodes;
  Simplices simplices;              ///< positively oriented; those outside too
  std::vector<std::uint8_t> label;  ///< per simplex, 0 outside
  std::int64_t crossing = 0;        ///< edges that cross an interface in the end: details finer than the edges
  int iterations = 0;
};

/// From nodes that are bound already, by a lattice for example. Throws UserError when there are too few.
Truss relax(Nodes start, const Materials& materials, Dimension dimension, const TrussSettings& settings);

/// From nodes of its own. `min_edge_mm` is the least of materials.edge_mm. Throws UserError when no node lies in any
/// label.
Truss relax(const Materials& materials, Dimension dimension, double min_edge_mm, const TrussSettings& settings);

}  // namespace heartgen::distmesh
