// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Fills missing axes by total variation (thesis 9.3): steady state of div(grad u / |grad u|) = 0 for the dyads
/// u = f f^T, which have no sign, on any graph of neighbours (voxel faces or mesh edges). Where missing elements meet
/// known ones the known values hold (Dirichlet); where they meet nothing, nothing flows (Neumann): the mixed boundary
/// conditions of (9.7).
#pragma once
#include <cstdint>
#include <vector>

#include "model/axis_tensor.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::fibers {

/// Neighbours of element e: neighbor[start[e]] to neighbor[start[e + 1] - 1], ascending; distance_mm alike.
struct NeighborGraph {
  std::vector<std::int64_t> start;  ///< elements + 1 values
  std::vector<std::int32_t> neighbor;
  std::vector<float> distance_mm;
};

/// Edges of the cells for which use[cell] != 0.
NeighborGraph edge_graph(const TetMesh& mesh, const std::vector<std::uint8_t>& use);

/// Replaces the tensors of elements with missing[e] != 0 by dyads of unit axes; the others are not touched. Elements
/// that no known one can be reached from stay missing. Returns the number of those filled. Threaded Jacobi sweeps:
/// the same bits for any number of threads.
std::int64_t inpaint_axes(const NeighborGraph& graph, int iterations, std::vector<AxisTensor>& axes,
                          std::vector<std::uint8_t>& missing);

}  // namespace heartgen::fibers
