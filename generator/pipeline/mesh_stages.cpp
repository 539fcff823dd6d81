// SPDX-License-Identifier: GPL-3.0-or-later
#include "generator/pipeline/mesh_stages.hpp"

#include "datasets/phantom/phantom.hpp"
#include "generator/adapters/itk_io.hpp"
#include "generator/anatomy/vessel.hpp"
#include "generator/atlas/atlas.hpp"
#include "generator/image/masks.hpp"
#include "generator/mesh/mesh_heart.hpp"
#include "generator/mesh/mesh_vessel.hpp"
#include "generator/pipeline/check_inputs.hpp"
#include "generator/pipeline/fov_cuts.hpp"
#include "generator/pipeline/torso_stage.hpp"
#include "model/labels.hpp"

namespace heartgen::pipeline {
namespace {

Meshes heart_meshes(const Recipe& recipe, const LabelVolume& labels) {
  if (recipe.input.size_field.empty()) return mesh::mesh_heart(labels, recipe.mesh);
  auto own_edges_mm = adapters::read_image(recipe.input.size_field);
  own_edges_mm.grid = grid_in_bundle(recipe, own_edges_mm.grid);
  return mesh::mesh_heart(labels, recipe.mesh, &own_edges_mm);
}

/// The body's field of view ends at the border of another patient's image, which is not that of the map, and at the
/// padding of the body's image.
void label_cuts(TetMesh& torso, const Build& b) {
  if (b.has_torso()) {
    label_torso_cuts(torso, b.around->torso_grid);
    label_padding_cuts(torso, b.around->torso_grid, b.around->torso_padding);
  } else {
    label_padding_cuts(torso, b.heart->grid, b.padding);
  }
}

Noted<Meshes> make_meshes(const Build& b) {
  const Recipe& recipe = b.recipe;
  const LabelVolume& labels = b.labels();
  Meshes meshes = heart_meshes(recipe, labels);
  if (meshes.contains("torso")) label_cuts(meshes.at("torso"), b);
  if (wants(recipe, "trachea") && labels::holds(labels, Region::trachea))
    meshes["trachea"] = mesh::mesh_vessel(image::mask_of(labels, Region::trachea), Region::trachea, recipe.mesh);
  if (wants(recipe, "carotid") && !recipe.input.carotid.empty()) {
    const Mask lumen = anatomy::segment_vessel(adapters::read_ct(recipe.input.carotid), carotid_seed(recipe));
    meshes["carotid"] = mesh::mesh_vessel(lumen, Region::carotid, recipe.mesh);
  }
  return {std::move(meshes)};
}

FiberAtlas read_atlas(const Recipe& recipe) {
  if (recipe.input.atlas.empty()) return standin_atlas();
  return atlas::read_fiber_atlas(recipe.input.atlas, recipe.input.atlas_array);
}

/// Of the meshes of the map, whatever is made beside them.
std::string mesh_section(Recipe recipe) {
  recipe.mesh.resolutions_mm.clear();
  return recipe_section(recipe, "mesh");
}

Noted<fibers::FiberResult> make_fibers(const Build& b) {
  const TetMesh& walls = b.meshes->at("myocardium");
  const auto landmarks = landmarks_in_bundle(b.recipe);
  auto result = b.recipe.fibers.method == "rule"
                    ? fibers::rule_fibers(walls, *b.heart, landmarks, b.recipe.fibers)
                    : fibers::map_fibers(walls, *b.heart, landmarks, read_atlas(b.recipe), b.recipe.fibers);
  Notes notes = std::move(result.warnings);
  auto parts = std::move(result.part_times);
  return {std::move(result), std::move(notes), std::move(parts)};
}

Noted<Resolutions> make_further(const Build& b) {
  return {make_resolutions(*b.heart, b.recipe.mesh, with_fibers(b.meshes->at("myocardium"), *b.fibers))};
}

Sources sources_of_meshes(const Build& b) {
  return {b.labels_key(), b.hash("ct") + b.hash("carotid") + b.hash("size_field"), mesh_section(b.recipe)};
}
Sources sources_of_fibers(const Build& b) {
  return {b.meshes.key, b.hash("atlas") + b.recipe.input.atlas_array, recipe_section(b.recipe, "landmarks"),
          recipe_section(b.recipe, "fibers")};
}
Sources sources_of_further(const Build& b) { return {b.labels_key(), b.fibers.key, recipe_section(b.recipe, "mesh")}; }

}  // namespace

FiberAtlas standin_atlas() {
  const TetMesh standin = phantom::make_standin_atlas();
  return atlas::make_fiber_atlas("stand-in atlas", standin.nodes_mm, standin.cells, standin.node_fibers.fiber);
}

TetMesh with_fibers(TetMesh myocardium, const fibers::FiberResult& result) {
  myocardium.node_fibers = result.node;
  myocardium.cell_fibers = result.cell;
  myocardium.fiber_source = result.source;
  myocardium.rule_difference_deg = result.rule_difference_deg;
  return myocardium;
}

Stages mesh_stages() {
  constexpr Needed has_resolutions = [](const Build& b) { return !b.recipe.mesh.resolutions_mm.empty(); };
  return {stage("mesh", 25, always, &Build::meshes, sources_of_meshes, make_meshes),
          stage("fibers", 20, always, &Build::fibers, sources_of_fibers, make_fibers),
          stage("resolutions", 20, has_resolutions, &Build::further, sources_of_further, make_further)};
}

}  // namespace heartgen::pipeline
