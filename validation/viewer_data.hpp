// The surfaces and fibre lines of the report's 3D view, small enough for a web page.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"
#include "validation/mesh_topology.hpp"

namespace heart::validation {

struct ViewerData {
  std::string index_json;   ///< parts, colours and where their arrays start
  std::string data_base64;  ///< little-endian arrays: uint16 positions, uint8 helix angles, uint32 triangles
  bool has_fibers = false;
  bool empty = true;  ///< nothing to show
};

struct ViewerSettings {
  std::size_t heart_triangles = 150000;  ///< at most, by clustering of vertices
  std::size_t body_triangles = 60000;
  double line_spacing_mm = 3;
  double line_length_mm = 14;
};

/// Closed surface of every region; the torso's skin is glass. Meshes: "myocardium", "chambers", "trachea", "carotid",
/// "torso"; a region is taken from the first of these that has it.
ViewerData viewer_data(const std::map<std::string, TetMesh>& meshes, const ViewerSettings& settings = {});

/// The same where they are there already: `faces` of each of these meshes, `helix_deg` of the myocardium's nodes (from
/// helix_angle_per_node; empty without a myocardium).
ViewerData viewer_data(const std::map<std::string, TetMesh>& meshes, const FacesOfMeshes& faces,
                       const std::vector<double>& helix_deg, const ViewerSettings& settings = {});

}  // namespace heart::validation
