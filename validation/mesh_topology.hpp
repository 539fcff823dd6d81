// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Faces, boundaries and components of a tetrahedral mesh, recomputed from its cells.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "model/tet_mesh.hpp"

namespace heartgen::validation {

/// A face with the cells that have it: `other` is -1 on the boundary. More than two cells is a defect (`cells` > 2).
struct MeshFace {
  Face nodes;  ///< ascending
  std::int32_t cell = -1;
  std::int32_t other = -1;
  std::int32_t cells = 1;
};

/// Every face of the cells once, ascending. None where a cell names a node that is not there.
std::vector<MeshFace> mesh_faces(const TetMesh& mesh);

/// Of several meshes by name.
using FacesOfMeshes = std::map<std::string, std::vector<MeshFace>>;

FacesOfMeshes faces_of_meshes(const std::map<std::string, TetMesh>& meshes);

/// What a closed surface of triangles looks like.
struct SurfaceTopology {
  std::int64_t open_edges = 0;             ///< edges of an odd number of faces: the surface has holes
  std::int64_t non_manifold_edges = 0;     ///< edges of four or more faces
  std::int64_t non_manifold_vertices = 0;  ///< where several sheets touch in a vertex only
  std::int64_t euler_characteristic = 0;   ///< vertices - edges + faces: 2 for a sphere, 0 for a torus
};

SurfaceTopology surface_topology(const std::vector<Face>& faces);

/// Number of sets of cells that hang together through faces.
std::int64_t component_count(const TetMesh& mesh, const std::vector<MeshFace>& faces);

/// The same per region, through faces between its own cells.
std::map<std::int32_t, std::int64_t> component_counts(const TetMesh& mesh, const std::vector<MeshFace>& faces);

/// For every node the smallest node of its part; parts hang together through nodes of cells.
std::vector<std::int32_t> node_parts(const TetMesh& mesh);

std::int64_t orphan_nodes(const TetMesh& mesh);     ///< nodes of no cell
std::int64_t duplicate_nodes(const TetMesh& mesh);  ///< nodes at exactly the place of another
std::int64_t duplicate_cells(const TetMesh& mesh);  ///< cells with exactly the nodes of another

/// How the listed, labelled faces agree with those that the cells imply.
struct FaceLabels {
  std::int64_t missing_boundary_faces = 0;   ///< outer faces of the cells that are not listed
  std::int64_t missing_interface_faces = 0;  ///< faces between regions that are not listed
  std::int64_t repeated_faces = 0;           ///< listed more than once
  std::int64_t faces_without_cells = 0;      ///< listed, but no face of any cell
  std::int64_t faces_inside_regions = 0;     ///< listed, but the same region is on both sides
  std::int64_t unlabelled_faces = 0;         ///< listed with surface 0
};

FaceLabels check_face_labels(const TetMesh& mesh, const std::vector<MeshFace>& faces);

}  // namespace heartgen::validation
