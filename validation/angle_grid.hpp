// Helix angles on a regular grid: what the 3D view colours the faces of a cut with.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heart::validation {

struct AngleGrid {
  Vec3 low_mm;
  double spacing_mm = 2;
  std::array<std::int64_t, 3> count{};
  std::vector<double> angle_deg;  ///< NaN where unknown; x fastest
};

/// A grid around the nodes that have an angle: per cube the mean of its nodes, and around these, two cubes far, of the
/// known neighbours. Empty when no node has one. `helix_deg` is per node.
AngleGrid angle_grid(const TetMesh& walls, const std::vector<double>& helix_deg);

}  // namespace heart::validation
