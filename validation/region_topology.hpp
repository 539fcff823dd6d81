// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The topology of one region: pieces, handles and cavities, of a mesh and of a label map in the same terms, so that
/// the two can be compared. A region is taken as an open set: cells hang together through faces, voxels through the
/// faces of 6 neighbours, and what lies around them through edges and corners too.
#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "model/tet_mesh.hpp"
#include "model/volume.hpp"
#include "validation/mesh_topology.hpp"

namespace heartgen::validation {

struct RegionTopology {
  std::vector<double> components_ml;  ///< volumes of the connected pieces, largest first
  std::int64_t handles = 0;           ///< of all pieces together: the genus of their boundaries
  std::int64_t cavities = 0;          ///< parts of the rest that the region encloses
};

/// Of every region of the mesh, from the Euler characteristic of the cells, faces, edges and nodes inside it: pieces -
/// handles + cavities. `faces` from mesh_faces.
std::map<std::int32_t, RegionTopology> region_topologies(const TetMesh& mesh, const std::vector<MeshFace>& faces);

/// The same of the voxels with value `label`; beyond the image is the outside.
RegionTopology region_topology(const LabelVolume& labels, std::uint8_t label);

/// Volumes (ml) of the pieces of a label that do not even touch each other at edges or corners of voxels, largest
/// first: smooth surfaces may join what touches.
std::vector<double> separate_pieces_ml(const LabelVolume& labels, std::uint8_t label);

}  // namespace heartgen::validation
