// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The tetrahedra of a graded body-centred cubic lattice: nodes at the corners and centres of an octree's leaves, cells
/// between the centres of neighbouring leaves and the edges of the face that they share. Labelle and Shewchuk 2007,
/// section 4: all dihedral angles lie between 45 and 120 degrees on cubic cells.
#pragma once
#include <vector>

#include "generator/stuffing/active_leaves.hpp"
#include "generator/stuffing/octree.hpp"
#include "generator/tetmesh/materials.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::stuffing {

struct Background {
  std::vector<Vec3> nodes_mm;
  std::vector<float> spacing_mm;          ///< per node: size of the smallest leaf that it belongs to
  std::vector<tetmesh::LabelBits> sides;  ///< per node: sides of the box on which it lies
  std::vector<Cell> cells;                ///< positively oriented, leaf after leaf
  // Of a part only, else empty:
  std::vector<std::uint8_t> label;        ///< per node
  std::vector<std::uint8_t> lacks_cells;  ///< per node: 1 where it has other cells, which were not made
};

/// The lattice of the whole box.
Background make_background(const Octree& tree);

/// The cells of near leaves, but those between one and a leaf that is not near.
Background make_background(const Octree& tree, const std::function<int(const Vec3&)>& label_at, const NearLeaves& near);

}  // namespace heartgen::stuffing
