// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The walls of the heart alone, their five regions as parts of one solid: for those who need no blood. The solid's
/// surface is smoothed as a distance is (solid.hpp), and its regions meet where both are as near.
#pragma once
#include <cstdint>
#include <vector>

#include "generator/mesh/lattice_cells.hpp"
#include "generator/mesh/level_set_at.hpp"
#include "generator/mesh/solid.hpp"
#include "model/recipe.hpp"
#include "model/tet_mesh.hpp"

namespace heartgen::mesh {

struct WallLevelSets {
  MeshDomain domain;                 ///< of the part of the label map around the walls
  LevelSet solid;                    ///< of all walls, negative inside, on finer voxels
  Signs signs;                       ///< of the solid
  std::vector<std::uint8_t> labels;  ///< region tags of the walls that occur, ascending
  std::vector<LevelSet> distances;   ///< to each of them, mm, negative inside, on the grid of the domain
  std::vector<std::uint8_t> cubes;   ///< as in MeshDomain: where one wall is the nearest
};

/// Throws UserError for a label that is not in the table of regions, and a map without any wall.
WallLevelSets wall_level_sets(const LabelVolume& labels, const MeshSettings& settings);

/// The region at a position: a wall's tag or 0.
int wall_at(const WallLevelSets& walls, const Vec3& lps_mm);

/// The tag of the wall that is nearest, wherever the position.
std::uint8_t nearest_wall(const WallLevelSets& walls, const Vec3& lps_mm);

/// The regions at the voxel centres of the domain's grid.
LabelVolume labels_of(const WallLevelSets& walls);

/// Cells with the regions of the walls, nodes in LPS mm. Each outer face has the surface between its wall and what the
/// label map has beyond it, each face between walls their junction; rims of valve orifices are the nodes where the
/// endocardium of one chamber ends against that of the other. `own_edges_mm` and `report` as in
/// mesh_labels. Throws UserError for edges that are not positive.
TetMesh mesh_walls(const WallLevelSets& walls, const MeshSettings& settings, LatticeReport* report = nullptr,
                   const Volume<float>* own_edges_mm = nullptr);

}  // namespace heartgen::mesh
