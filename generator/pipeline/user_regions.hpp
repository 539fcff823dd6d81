// SPDX-License-Identifier: GPL-3.0-or-later
/// @file
/// The user's own regions ([[regions]] of a recipe) on the meshes of a bundle.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "generator/painting/region_masks.hpp"
#include "model/recipe.hpp"
#include "model/report.hpp"
#include "model/tet_mesh.hpp"
#include "model/volume.hpp"

namespace heartgen::pipeline {

/// The regions of the recipe's files. Throws UserError as read_regions, and for one that does not touch the walls of
/// `heart`, whose frame is the files'. Root only.
std::vector<painting::RegionMask> regions_on_walls(const Recipe& recipe, const LabelVolume& heart);

/// Paints the walls of all meshes that have some, and the torso that the walls are part of. Rows of group "regions":
/// `outside_walls`, the share of each region that no cell of the main mesh holds.
Report paint_meshes(std::map<std::string, TetMesh>& meshes, std::vector<painting::RegionMask> regions,
                    const Recipe& recipe);

}  // namespace heartgen::pipeline
