// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/user_regions.hpp"

#include <algorithm>

#include "generator/painting/paint.hpp"
#include "generator/pipeline/torso_stage.hpp"
#include "model/labels.hpp"

namespace heartgen::pipeline {

std::vector<painting::RegionMask> regions_on_walls(const Recipe& recipe, const LabelVolume& heart) {
  auto regions = painting::read_regions(recipe.regions);
  if (!regions.empty()) painting::refuse_regions_elsewhere(regions, painting::walls_of(heart));
  return regions;
}

Report paint_meshes(std::map<std::string, TetMesh>& meshes, std::vector<painting::RegionMask> regions,
                    const Recipe& recipe) {
  Report rows;
  if (regions.empty()) return rows;
  for (auto& region : regions) region.mask.grid = grid_in_bundle(recipe, region.mask.grid);
  const auto is_wall = [](std::int32_t region) { return is_myocardium(static_cast<Region>(region)); };
  for (auto& [name, mesh] : meshes)
    if (name.starts_with("myocardium")) painting::paint(mesh, regions, is_wall);
  const TetMesh& walls = meshes.at("myocardium");
  if (const auto torso = meshes.find("torso"); torso != meshes.end())
    painting::carry_regions_to_parent(walls, torso->second);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const double held = painting::volume_mm3(walls, walls.user_regions[r]) / painting::volume_mm3(regions[r].mask);
    rows.push_back({"regions", "myocardium/" + regions[r].name, "outside_walls", std::max(0.0, 1 - held), "1", {}, {}});
  }
  return rows;
}

}  // namespace heartgen::pipeline
