// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Laplace's equation on part of a tetrahedral mesh, with linear finite elements.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::mesh_queries {

/// Stiffness matrix of some cells, over the nodes that they use.
struct Stiffness {
  std::vector<std::int32_t> nodes;  ///< of the mesh, ascending; rows and columns are numbered like these
  std::vector<std::int32_t> cells;  ///< of the mesh, as given
  std::vector<std::array<std::int32_t, 4>> corners;  ///< per entry of `cells`: its corners' rows
  std::vector<std::size_t> start;                    ///< rows + 1 values
  std::vector<std::int32_t> column;                  ///< ascending in each row
  std::vector<double> value;
};

/// Gradients of the four linear shape functions of a cell, per mm; zero for a cell without volume.
std::array<Vec3, 4> shape_gradients(const TetMesh& mesh, const Cell& cell);

Stiffness make_stiffness(const TetMesh& mesh, const std::vector<std::int32_t>& cells);

/// Per row: not a number where the value is sought.
using FixedValues = std::vector<double>;

/// Per row of `matrix`: the harmonic function with the fixed values; nothing flows through the rest of the boundary.
/// Parts without a fixed value get 0. Conjugate gradients with symmetric Gauss-Seidel steps as preconditioner, to a
/// residual of 1e-6 of the first. Serial, always the same bits; several problems may be solved at the same time.
std::vector<double> solve_laplace(const Stiffness& matrix, const FixedValues& fixed);

/// Per row: mean of the gradients (per mm) of the cells around, weighted by volume.
std::vector<Vec3> node_gradients(const TetMesh& mesh, const Stiffness& matrix, const std::vector<double>& solution);

}  // namespace heartgen::mesh_queries
