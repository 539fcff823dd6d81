// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Lines along the fibres of a mesh.
#pragma once
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::report {

struct StreamlineSettings {
  double step_mm = 0.7;
  double length_mm = 18;  ///< both ways together
};

struct Streamline {
  std::int32_t seed = -1;  ///< the node that it goes through
  std::vector<Vec3> points_mm;
  std::vector<double> helix_deg;  ///< per point, interpolated from the nodes; NaN where unknown
};

/// One node per cube of `spacing_mm` (the first in node order) among those with allowed[n] != 0.
std::vector<std::int32_t> thinned_nodes(const TetMesh& mesh, const std::vector<std::uint8_t>& allowed,
                                        double spacing_mm);

/// Streamlines through the given nodes, by Runge-Kutta of order 4 on axes (the sign of each fibre follows the line),
/// up to the boundary of the mesh. `helix_deg` is per node.
std::vector<Streamline> trace_fibers(const TetMesh& mesh, const std::vector<std::int32_t>& seeds,
                                     const std::vector<double>& helix_deg, const StreamlineSettings& settings);

}  // namespace heartgen::report
