// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The Delaunay simplices of nodes and their edges.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "generator/distmesh/nodes.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::distmesh {

using Edge = std::array<std::int32_t, 2>;  ///< ascending

/// Triangles use the first three ids of a Cell; the fourth is -1.
struct Simplices {
  std::vector<Cell> cells;
  std::size_t corners = 3;
};

Simplices delaunay(const Nodes& nodes, Dimension dimension);

/// Every edge once, ascending.
std::vector<Edge> edges_of(const Simplices& simplices, std::size_t node_count);

/// Faces (edges, in two dimensions: the first node is -1) that one simplex has alone, nodes and faces ascending.
std::vector<Face> hull_faces(const Simplices& simplices);

Vec3 center_of(const Nodes& nodes, const Cell& cell, std::size_t corners);

/// What a simplex is made of: the label that all of its nodes touch; where there is none or more than one, the label at
/// its centre. 0 (outside) where its centre and all nodes but one are at the end of the mesh or beyond.
int label_of(const Nodes& nodes, const Cell& cell, std::size_t corners, const Materials& materials);

/// Pieces of a label (0 too) of at most two simplices that hang together through faces take the label that they share
/// most faces with.
void absorb_crumbs(const Simplices& simplices, std::vector<std::uint8_t>& label);

}  // namespace heartgen::distmesh
