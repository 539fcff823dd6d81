// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// First nodes: a dense regular lattice, thinned to the wanted edge length.
#pragma once
#include "generator/distmesh/nodes.hpp"

namespace heartgen::distmesh {

/// Adds nodes inside the labels, and outside within about half an edge of them (those are to be bound), but none within
/// half an edge of the nodes that are there. Lattices of widths that are powers of sqrt(2) of the least edge share the
/// work: each fills the places where the wanted edge is between its width and the next, and keeps a node with a
/// probability of (width / edge)^dimension, by numbers that depend on the node's place only. Persson and Strang 2004,
/// with one lattice of the least width. `min_edge_mm` is the least of materials.edge_mm.
void add_start_nodes(Nodes& nodes, const Materials& materials, Dimension dimension, double min_edge_mm);

}  // namespace heartgen::distmesh
