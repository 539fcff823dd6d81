// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The triangles of the report's 3D view: the closed surface of every region, thinned by merging neighbouring nodes.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"
#include "validation/mesh_topology.hpp"
#include "validation/wall_fields.hpp"

namespace heartgen::report {

/// One surface of the view. What is per triangle is of the cell inside the surface.
struct ViewPart {
  std::string mesh;         ///< that it was taken from
  std::int32_t region = 0;  ///< tag
  bool is_glass = false;    ///< the body's outside
  bool is_valve = false;    ///< an orifice; `region` is then the tag of the surface
  bool is_thinned = false;  ///< its triangles are not those of the mesh
  std::vector<Vec3> points_mm;
  std::vector<Vec3> fibers;                       ///< per point, axes; empty where there are none
  std::vector<std::vector<std::uint8_t>> fields;  ///< per wall field, bytes per point; empty off the walls
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::int32_t> surface;        ///< per triangle, tag; 0: not listed by the mesh
  std::vector<std::uint8_t> quality_deg{};  ///< per triangle: smallest dihedral angle
};

struct ViewerSettings {
  std::size_t heart_triangles = 150000;  ///< at most, by clustering of nodes
  std::size_t body_triangles = 60000;
  double line_spacing_mm = 4.5;
  double line_length_mm = 10;
};

/// Meshes: "myocardium", "chambers", "trachea", "carotid", "torso"; a region is taken from the first of these that has
/// it, a valve's orifice from the first that lists its faces. `fields` are those of the myocardium.
std::vector<ViewPart> view_parts(const std::map<std::string, TetMesh>& meshes, const validation::FacesOfMeshes& faces,
                                 const std::vector<validation::WallField>& fields, const ViewerSettings& settings);

/// Edges of exactly one triangle of a part: the rim of an orifice.
std::vector<std::array<std::uint32_t, 2>> rim_edges(const ViewPart& part);

}  // namespace heartgen::report
