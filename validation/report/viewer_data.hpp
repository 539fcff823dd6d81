// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The data of the report's 3D view, small enough for a web page.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"
#include "validation/mesh_topology.hpp"
#include "validation/report/view_surfaces.hpp"
#include "validation/wall_fields.hpp"

namespace heartgen::report {

struct ViewerData {
  std::string index_json;   ///< parts, fields, colours, and where their arrays start
  std::string data_base64;  ///< deflated little-endian arrays: uint16 positions, uint8 fields, uint32 triangles
  bool has_fibers = false;
  bool has_valves = false;
  bool empty = true;  ///< nothing to show
};

/// Surfaces of view_parts, lines along the fibres on them and inside the walls, and the fields on a grid for cuts.
/// `fields` from wall_fields; none without a myocardium.
ViewerData viewer_data(const std::map<std::string, TetMesh>& meshes, const validation::FacesOfMeshes& faces,
                       const std::vector<validation::WallField>& fields, const ViewerSettings& settings = {});

}  // namespace heartgen::report
