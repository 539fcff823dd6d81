// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Values on the nodes of the heart's walls, for colouring: each as a byte of the page's data.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/tet_mesh.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::validation {

struct WallField {
  std::string id;     ///< "helix", "thickness", "source", "difference", "quality"
  std::string title;  ///< of its legend
  std::string unit;
  double low = 0, high = 1;             ///< what the legend spans; values beyond are shown as its ends
  std::vector<double> values;           ///< per node; NaN: unknown
  std::vector<std::string> categories;  ///< names of the values 0, 1, ...; empty: a scale
};

/// 0: unknown; 1 .. 255: low .. high, or 1 + the category.
std::uint8_t byte_of(const WallField& field, double value);

/// Those that the mesh knows; `helix_deg` per node from helix_angle_per_node. Thickness: the distances of a node to the
/// blood of its own wall and to the other side, together; papillary muscles have none.
std::vector<WallField> wall_fields(const TetMesh& walls, const std::vector<double>& helix_deg);

/// Smallest dihedral angle of a cell, degrees.
double min_dihedral_deg(const TetMesh& mesh, std::size_t cell);

}  // namespace heartgen::validation
