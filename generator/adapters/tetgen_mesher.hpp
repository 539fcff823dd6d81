// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// Constrained Delaunay refinement between given surfaces: TetGen hidden behind plain data. The surfaces stay as they
/// are, triangle for triangle; only nodes inside the materials are added. Si, ACM Transactions on Mathematical
/// Software 41 (2015). TetGen is under the AGPL: it is linked only where CMake was told so (HEARTGEN_TETGEN).
#pragma once
#include <functional>
#include <vector>

#include "model/labelled_cells.hpp"
#include "model/tet_mesh.hpp"
#include "model/vec.hpp"

namespace heartgen::adapters {

/// A point strictly inside a piece of a material.
struct MaterialSeed {
  Vec3 point_mm;
  std::int32_t label = 0;  ///< positive
};

/// Triangles that meet in common edges and nodes only, and bound every piece of every material.
struct SurfaceComplex {
  std::vector<Vec3> nodes_mm;       ///< each is used by a face
  std::vector<Face> faces;          ///< each once, in any direction
  std::vector<MaterialSeed> seeds;  ///< one in each piece; pieces without one stay empty
};

struct FillSettings {
  double radius_edge_ratio = 1.4;  ///< greatest circumradius over shortest edge of a cell away from the surfaces
  double min_angle_deg = 16;       ///< dihedral angle that refinement asks for; it stops at the surfaces
  double volume_share = 0.2;       ///< greatest volume of a cell, as a share of the cube of the wanted edge
};

/// Whether the program was built with TetGen.
bool has_tetgen();

/// The cells of all pieces with a seed. The first nodes are those of `surfaces`, in their order. `edge_mm` gives the
/// wanted edge length, positive. One call at a time per thread; the same input gives the same bits.
/// Throws UserError where the surfaces cross or touch, or TetGen gives up; and when there is no TetGen.
LabelledCells fill_surfaces(const SurfaceComplex& surfaces, const std::function<double(const Vec3&)>& edge_mm,
                            const FillSettings& settings);

}  // namespace heartgen::adapters
