// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Triangle mesh of a plane with regions and labelled edges. Plain data; nodes in LPS mm.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen {

struct TriMesh {
  std::vector<Vec3> nodes_mm;
  std::vector<Face> triangles;       ///< node ids, all in the same sense
  std::vector<std::int32_t> region;  ///< per triangle, a key of region_names

  std::vector<std::array<std::int32_t, 2>> edges;  ///< outer boundary and region interfaces, each edge once
  std::vector<std::int32_t> curve;                 ///< per edge, a key of curve_names

  std::map<std::int32_t, std::string> region_names, curve_names;
};

}  // namespace heartgen
