// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Tetrahedral mesh with regions, labelled faces, rims and fibres. Plain data; nodes in LPS mm.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "model/vec.hpp"

namespace heartgen {

using Cell = std::array<std::int32_t, 4>;  ///< node ids; det(n1-n0, n2-n0, n3-n0) > 0
using Face = std::array<std::int32_t, 3>;  ///< node ids

/// Orthonormal material axes. Signs are arbitrary: these are axes, not vectors. All three arrays have the same
/// length (nodes or cells), or are empty.
struct FiberField {
  std::vector<Vec3> fiber;
  std::vector<Vec3> sheet;
  std::vector<Vec3> sheet_normal;
};

enum class FiberSource : std::uint8_t { none = 0, atlas = 1, inpainted = 2, rule = 3 };

/// What a file calls its groups of cells (dimension 3) and faces (2), by dimension and tag.
using GroupNames = std::map<std::pair<int, std::int32_t>, std::string>;

/// The curve where a labelled surface ends, as a set of nodes.
struct Rim {
  std::string name;                 ///< e.g. "mitral_orifice_rim"
  std::int32_t tag = 0;             ///< 1000 + tag of the surface
  std::vector<std::int32_t> nodes;  ///< ascending
};

/// A region of the user's own on the cells of a mesh: scar, fibrosis, an ablation line.
struct UserRegion {
  std::string name;
  std::int32_t tag = 0;         ///< from first_user_region on (labels.hpp)
  std::vector<float> fraction;  ///< per cell: the part of its volume that lies in the region, 0 to 1
};

/// The closed surface of a pool of blood: the faces of a mesh that it touches, and over each of its openings a cap of
/// triangles between the nodes of the rim alone. A manifold; its normals look out of the blood.
struct Cavity {
  std::string name;                   ///< e.g. "lv_cavity"
  std::int32_t region = 0;            ///< of the blood, also where the mesh holds none of it
  std::vector<Face> faces;            ///< node ids of the mesh
  std::vector<std::int32_t> surface;  ///< per face: that of the mesh's face, or the cap's (labels.hpp: cap_tag)
};

struct TetMesh {
  std::vector<Vec3> nodes_mm;
  std::vector<Cell> cells;
  std::vector<std::int32_t> region;  ///< per cell, tags of labels.hpp

  std::vector<Face> faces;            ///< outer boundary and region interfaces, each face once
  std::vector<std::int32_t> surface;  ///< per face, tags of labels.hpp; never 0
  std::vector<Rim> rims;

  FiberField node_fibers;                  ///< empty, or per node
  FiberField cell_fibers;                  ///< empty, or per cell
  std::vector<std::uint8_t> fiber_source;  ///< FiberSource per node; empty where there are no fibres
  std::vector<float>
      rule_difference_deg;  ///< per cell: from cell_fibers.fiber to the rule's axis; -1: no such; or empty

  std::vector<UserRegion> user_regions;
  std::vector<std::int32_t> user_region;  ///< per cell: tag of the user's region that it counts for, 0: none; or empty

  std::vector<Cavity> cavities;

  /// For a mesh cut out of a larger one of the same bundle (myocardium out of torso): ids there. Else empty.
  std::vector<std::int32_t> parent_node;
  std::vector<std::int32_t> parent_cell;

  GroupNames names;  ///< of a mesh from elsewhere; tags without one are called as in labels.hpp
};

/// Signed volume of a cell in mm^3.
inline double cell_volume_mm3(const TetMesh& mesh, const Cell& c) {
  const auto& p = mesh.nodes_mm;
  const Vec3 a = p[static_cast<std::size_t>(c[0])];
  return dot(p[static_cast<std::size_t>(c[1])] - a,
             cross(p[static_cast<std::size_t>(c[2])] - a, p[static_cast<std::size_t>(c[3])] - a)) /
         6;
}

/// Volume in mm^3 inside of a closed surface whose normals look outwards.
inline double enclosed_volume_mm3(const std::vector<Vec3>& nodes_mm, const std::vector<Face>& faces) {
  if (faces.empty()) return 0;
  const Vec3 origin = nodes_mm[static_cast<std::size_t>(faces[0][0])];  // near: less is cancelled
  double volume = 0;
  for (const auto& face : faces) {
    const auto at = [&](std::size_t i) { return nodes_mm[static_cast<std::size_t>(face[i])] - origin; };
    volume += dot(at(0), cross(at(1), at(2))) / 6;
  }
  return volume;
}

}  // namespace heartgen
